# Image of the server and its workers: see docs/docker.md. BASE is any Debian with Python 3.11 or later and its venv module.
ARG BASE=python:3.11-slim-bookworm
FROM ${BASE} AS build
# Optional: URL of a package index, its password in the secret `netrc`, and trusted certificates in the secret `ca`.
ARG PIP_INDEX_URL
ENV UV_DEFAULT_INDEX=${PIP_INDEX_URL} UV_NO_CACHE=1 UV_COMPILE_BYTECODE=1 UV_PYTHON_DOWNLOADS=never
WORKDIR /build
COPY requirements requirements
# No program reads the tests of SciPy and sympy, nor the stubs with which jedi completes code.
RUN --mount=type=secret,id=netrc,target=/root/.netrc --mount=type=secret,id=ca \
    if [ -e /run/secrets/ca ]; then export PIP_CERT=/run/secrets/ca SSL_CERT_FILE=/run/secrets/ca; fi \
    && python3 -m venv /opt/uv \
    && /opt/uv/bin/pip install --no-cache-dir --disable-pip-version-check --require-hashes -r requirements/installer.lock \
    && python3 -m venv --without-pip /opt/venv \
    && /opt/uv/bin/uv pip install --python /opt/venv --require-hashes -r requirements/runtime.lock \
    && find /opt/venv/lib/python3*/site-packages/scipy /opt/venv/lib/python3*/site-packages/sympy -type d -name tests -prune -exec rm --recursive {} + \
    && rm --recursive /opt/venv/lib/python3*/site-packages/jedi/third_party
COPY pyproject.toml README.md LICENSE ./
COPY reference reference
COPY exercises exercises
COPY service service
# Loading the assignments writes the indexes from which a server lists them.
RUN /opt/uv/bin/uv pip install --python /opt/venv --offline --no-deps --no-build-isolation ./exercises/kit . \
    && cd / && /opt/venv/bin/python -c "from exercises.authoring.assignments import catalogue; catalogue.assignments()"

FROM ${BASE}
LABEL org.opencontainers.image.title="polhode" org.opencontainers.image.licenses="MIT" \
    org.opencontainers.image.description="Auto-graded course assignment server for physics notebooks"
RUN useradd --uid 10001 --home-dir /var/lib/polhode --shell /usr/sbin/nologin polhode \
    && install --directory --owner=polhode --group=polhode /var/lib/polhode \
    && python3 -m compileall -q -x '(site|dist)-packages|/tests?/' "$(python3 -c 'import sysconfig; print(sysconfig.get_path("stdlib"))')"
COPY --from=build /opt/venv /opt/venv
ENV PATH=/opt/venv/bin:$PATH LANG=C.UTF-8 HOME=/var/lib/polhode POLHODE_DATA=/var/lib/polhode/data POLHODE_HOST=0.0.0.0 \
    OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
USER 10001
WORKDIR /var/lib/polhode
VOLUME /var/lib/polhode
EXPOSE 8000
HEALTHCHECK --interval=10s --timeout=6s --start-period=60s CMD ["python3", "-c", \
    "import os, urllib.request as u; u.urlopen(f'http://localhost:{os.getenv(\"POLHODE_PORT\", 8000)}/readyz', timeout=5)"]
CMD ["polhode", "serve"]
