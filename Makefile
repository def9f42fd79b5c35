# polhode: every target works on a fresh Debian machine with python3.11+ (venv, pip), make and git.
PYTHON ?= python3
BIN := .venv/bin
# Always write bytecode: without it every import of SciPy takes two seconds.
INSTALL := umask 022; env -u PYTHONDONTWRITEBYTECODE PYTHONUNBUFFERED=1 $(BIN)/python -m pip install --quiet --disable-pip-version-check
CLEAN_ENV := env -u PYTHONDONTWRITEBYTECODE OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
# Tests wait a lot, so several processes run whole files, in the order of tests/conftest.py.
TEST = $(CLEAN_ENV) $(BIN)/python -m pytest --numprocesses $(or $(PROCESSES),3) --dist loadfile --no-loadscope-reorder

# Newer Pythons on the PATH or in pyenv; each is run, as a stub of pyenv is also found for a version that is not active.
NEWER = $(or $(PYTHONS),$(foreach minor,12 13 14,$(firstword $(shell python3.$(minor) -c 'import sys; print(sys.executable)' 2>/dev/null) \
	$(wildcard $(HOME)/.pyenv/versions/3.$(minor).*/bin/python3.$(minor)))))

IMAGE_TOOLS := podman runc catatonit netavark aardvark-dns iptables mmdebstrap podman-compose

.PHONY: help env demo serve test test-all verdicts exhaustive sabotage test-pythons lint docs pictures bench chaos image-test release-check lock clean

help:  ## list the targets
	@grep -hE '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed 's/:.*## /\t/' | expand -t 12

env: .venv/runtime  ## install polhode into .venv from the hashed lock file

.venv/runtime: requirements/runtime.lock pyproject.toml exercises/kit/pyproject.toml
	@echo "polhode: installing into .venv (first time: one or two minutes)"
	@test -x $(BIN)/python || $(PYTHON) -m venv .venv
	@$(INSTALL) --require-hashes -r requirements/runtime.lock
	@$(INSTALL) --no-deps --no-build-isolation -e exercises/kit -e .
	@chmod -R o+rX exercises/kit service/sandbox/guest  # a sandbox that root starts reads them as another user
	@rm -rf .venv/lib/python3*/site-packages/service  # hatch's copy of a file of an editable package
	@touch $@

.venv/tests: .venv/runtime requirements/test.lock
	@echo "polhode: installing the test dependencies"
	@$(INSTALL) --require-hashes -r requirements/test.lock
	@touch $@

.venv/docs: .venv/runtime requirements/docs.lock
	@echo "polhode: installing the documentation's generator"
	@$(INSTALL) --require-hashes -r requirements/docs.lock
	@touch $@

.venv/release: .venv/runtime requirements/release.lock
	@echo "polhode: installing the tools of a release"
	@$(INSTALL) --require-hashes -r requirements/release.lock
	@touch $@

# Install a browser if permitted; without one the browser tests are skipped.
.venv/browser: .venv/tests
	@command -v chromium >/dev/null || { test "$$(id -u)" = 0 && command -v apt-get >/dev/null && echo "polhode: installing chromium" \
		&& apt-get -qq update && DEBIAN_FRONTEND=noninteractive apt-get -qq install --no-install-recommends chromium fonts-dejavu-core >/dev/null 2>&1; } \
		|| echo "polhode: no chromium found: browser tests will be skipped"
	@touch $@

demo: env  ## start a server, grade samples over HTTP and print their reports (ONCE=1: then stop; PORT=N)
	@$(CLEAN_ENV) $(BIN)/python -m service.cli.server.demo $(if $(ONCE),--once) $(if $(PORT),--port $(PORT))

serve: env  ## start the server on port 8000 with its data in .data
	@$(CLEAN_ENV) POLHODE_DATA=$${POLHODE_DATA:-.data} $(BIN)/polhode serve

lint: .venv/tests  ## run ruff, mypy (strict) and the import contracts
	@$(BIN)/ruff check --quiet .
	@$(BIN)/ruff format --quiet --check .
	@$(BIN)/mypy
	@$(BIN)/lint-imports

test: lint .venv/browser  ## lint, then run the fast tests (four minutes on two cores; PROCESSES=3)
	@$(TEST) -m "not slow and not exhaustive"

test-all: .venv/browser .venv/docs  ## run also the slow tests: all samples over HTTP, browser, JupyterHub, several machines, wheels, outages
	@$(MAKE) --no-print-directory test
	@$(TEST) --numprocesses $(or $(PROCESSES),2) -m "slow and not exhaustive"  # a third process would starve the servers of others

verdicts: .venv/tests  ## grade every sample and compare with the frozen verdicts (WRITE=1: freeze what is found)
	@$(CLEAN_ENV) $(BIN)/python -m tests.support.verdicts $(if $(WRITE),--write)

exhaustive: test-all  ## run everything: samples on four seeds, mutants, sabotage, chaos, the image, and newer Pythons if installed
	@$(TEST) -m exhaustive
	@$(CLEAN_ENV) $(BIN)/polhode mutants rigid-body
	@$(MAKE) --no-print-directory sabotage
	@$(MAKE) --no-print-directory chaos KILLS=1000
	@$(MAKE) --no-print-directory image-test
	@$(MAKE) --no-print-directory test-pythons

test-pythons:  ## run `make test` in a clone with each newer Python on the PATH or in pyenv (PYTHONS="python3.13 ...")
	@test -n "$(NEWER)" || echo "polhode: no newer Python found"
	@for python in $(NEWER); do copy=$$(mktemp -d) && git clone --quiet . $$copy && $$python --version \
		&& $(MAKE) -C $$copy --no-print-directory test PYTHON=$$python && rm -rf $$copy || exit 1; done

docs: .venv/docs  ## build the documentation site in .site/html (SERVE=8001: then serve it on that port of this machine)
	@$(CLEAN_ENV) $(BIN)/python -m docs.site
	@$(if $(SERVE),$(BIN)/python -m http.server --bind 127.0.0.1 --directory .site/html $(SERVE),echo "polhode: the site is .site/html/index.html; make docs SERVE=8001 serves it")

pictures: .venv/browser .venv/release  ## draw the pictures of the docs from a demonstration of their own (ONLY="report queue")
	@$(CLEAN_ENV) $(BIN)/python -m tests.support.pictures $(ONLY)

bench: .venv/tests  ## measure exact motion, sandbox, checks, false ✗, queue, a deadline surge, attacks by connections, pages, and other autograders
	@$(CLEAN_ENV) $(BIN)/python -m bench.exact_speed
	@$(CLEAN_ENV) $(BIN)/python -m bench.sandbox
	@$(CLEAN_ENV) $(BIN)/python -m bench.forms
	@$(CLEAN_ENV) MPLBACKEND=Agg $(BIN)/python -m bench.checks
	@$(CLEAN_ENV) $(BIN)/python -m bench.notebook
	@$(CLEAN_ENV) $(BIN)/python -m bench.queue
	@$(CLEAN_ENV) $(BIN)/python -m bench.surge
	@$(CLEAN_ENV) $(BIN)/python -m bench.connections
	@$(CLEAN_ENV) $(BIN)/python -m bench.pages
	@$(CLEAN_ENV) $(BIN)/python -m bench.peers

chaos: .venv/tests  ## kill, freeze and disconnect servers, workers and databases under load; fail on any loss (KILLS=200 SEED=1)
	@$(CLEAN_ENV) $(BIN)/python -m tests.support.chaos --kills $(or $(KILLS),200) --seed $(or $(SEED),1)

sabotage: .venv/tests  ## break the code one line at a time, in copies; fail if the tests do not notice (JOBS=2)
	@$(CLEAN_ENV) $(BIN)/python -m tests.sabotage --jobs $(or $(JOBS),2)

image-test: .venv/tests  ## build the container image with podman and run it as in docs/docker.md and docker-compose.yml
	@{ command -v podman && command -v mmdebstrap && command -v podman-compose; } >/dev/null || { echo "polhode: installing $(IMAGE_TOOLS)" \
		&& apt-get -qq update && DEBIAN_FRONTEND=noninteractive apt-get -qq install --no-install-recommends $(IMAGE_TOOLS) >/dev/null; }
	@$(CLEAN_ENV) $(BIN)/python -m tests.image

release-check: .venv/release  ## check the docs' pictures, build wheel, sdist and image, and use them outside the clone with each Python (PYTHONS=...)
	@$(CLEAN_ENV) $(BIN)/python -m tests.support.release $(or $(PYTHONS),$(BIN)/python $(NEWER))
	@if test "$$(id -u)" = 0; then $(MAKE) --no-print-directory image-test; \
		else echo "polhode: the image is not built: make image-test does it as root"; fi

lock:  ## update the lock files (needs uv; UPGRADE=--upgrade for newer versions)
	uv lock $(UPGRADE)
	uv export --quiet --format requirements.txt --group build --no-emit-local --no-header --output-file requirements/runtime.lock
	uv export --quiet --format requirements.txt --all-groups --no-group docs --no-group release --all-extras --no-emit-local --no-header --output-file requirements/test.lock
	echo uv | uv pip compile --quiet $(UPGRADE) --universal --python-version 3.11 --generate-hashes --no-header --no-annotate --output-file requirements/installer.lock -
	for group in docs release; do uv pip compile --quiet $(UPGRADE) --universal --python-version 3.11 --generate-hashes --no-header --no-annotate \
		--constraint requirements/test.lock --group $$group --output-file requirements/$$group.lock; done
	@! grep -nE 'https?://' requirements/*.lock

clean:  ## remove everything that the other targets created
	rm -rf .venv .demo .data .bench .site .cache dist .pytest_cache .mypy_cache .ruff_cache
