#!/bin/bash
# Gradescope runs this once, as root, to build the image: it installs Python 3.11 or later, then polhode by its hashed lock file.
set -euo pipefail
cd "$(dirname "$0")"
export DEBIAN_FRONTEND=noninteractive PIP_DISABLE_PIP_VERSION_CHECK=1 PIP_NO_CACHE_DIR=1 PIP_ROOT_USER_ACTION=ignore
unset PYTHONDONTWRITEBYTECODE  # without bytecode every submission would compile SciPy again
venv=/autograder/polhode

# Print the first released Python on the PATH that is new enough and can create virtual environments.
find_python() {
    for python in python3 python3.14 python3.13 python3.12 python3.11; do
        if "$python" -c 'import ensurepip, sys, venv; sys.exit(not (sys.version_info >= (3, 11) and sys.version_info.releaselevel == "final"))' 2>/dev/null
        then command -v "$python"; return; fi
    done
    return 1
}

if ! python=$(find_python); then
    apt-get -qq update
    apt-get -qq install --no-install-recommends python3 python3-venv >/dev/null
    if ! python=$(find_python); then # Ubuntu 22.04: its python3 is 3.10, its python3.11 a release candidate
        apt-get -qq install --no-install-recommends software-properties-common >/dev/null
        add-apt-repository --yes ppa:deadsnakes/ppa >/dev/null
        apt-get -qq install --no-install-recommends python3.12 python3.12-venv >/dev/null
        python=$(find_python)
    fi
fi

"$python" -m venv $venv
$venv/bin/python -m pip install --quiet --require-hashes --requirement requirements.lock
$venv/bin/python -m pip install --quiet --no-deps --force-reinstall ./polhode_kit-*.whl ./polhode-*.whl
$venv/bin/polhode doctor || echo "polhode: the machine that built this image cannot grade (see above); the machines that run it may still be able to." >&2
