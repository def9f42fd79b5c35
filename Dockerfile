# Build stage: everything from the hashed lock into one virtual environment, bytecode compiled.
ARG BASE=python:3.11-slim-bookworm
FROM ${BASE} AS build
WORKDIR /opt/polhode
COPY requirements.lock ./
RUN python3 -m venv /opt/venv && /opt/venv/bin/pip install --no-cache-dir --require-hashes -r requirements.lock
COPY pyproject.toml README.md LICENSE ./
COPY reference reference
COPY exercises exercises
COPY service service
RUN /opt/venv/bin/pip install --no-cache-dir --no-deps --no-build-isolation .

FROM ${BASE}
RUN useradd --system --create-home --home-dir /var/lib/polhode polhode
COPY --from=build /opt/venv /opt/venv
ENV PATH=/opt/venv/bin:$PATH POLHODE_DATA=/var/lib/polhode/data POLHODE_HOST=0.0.0.0 OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
USER polhode
EXPOSE 8000
VOLUME /var/lib/polhode
HEALTHCHECK --interval=10s --start-period=30s CMD python3 -c "import urllib.request as u; u.urlopen('http://127.0.0.1:8000/readyz', timeout=5)"
CMD ["polhode", "serve"]
