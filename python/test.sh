#!/bin/sh
# Builds furrow for Python as its users do, by pip in an environment of its own, and tries it: `python/test.sh [ARGUMENT OF PYTEST...]`. The
# environment is kept in target/python. Fails without a Python of 3.10 or later, or where packages cannot be had.
set -eu
cd "$(dirname "$0")/.."

python=${PYTHON:-python3}
if ! "$python" -c 'import sys, venv; sys.exit(sys.version_info < (3, 10))' 2>/dev/null; then
    echo "$python: must be a Python of 3.10 or later with venv (PYTHON names another)" >&2
    exit 1
fi
environment=target/python
[ -x "$environment/bin/python" ] || "$python" -m venv "$environment"
pip="$environment/bin/python -m pip --disable-pip-version-check --quiet"
$pip install "maturin>=1.8,<2" "numpy>=1.24"
$pip install "./python[test]"
# What is tried is what was installed, not the folder it was made from; the examples in its documentation too.
exec "$environment/bin/python" -m pytest -q -p no:cacheprovider -c python/pyproject.toml --rootdir python --pyargs furrow python/tests "$@"
