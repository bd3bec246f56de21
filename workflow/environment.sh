#!/bin/sh
# Rebuild the environment .venv of PYTHON, or python3, from requirements/study.txt and this project. Programs of an environment contain
# its path, so it is built in place; if that fails, the previous environment is restored.
set -eu
old=.venv.old

restore() {
    [ -d $old ] || return 0
    rm -rf .venv
    mv $old .venv
}

restore # of a try that was killed
instead=
if [ -d .venv ]; then
    mv .venv $old
    instead=" in place of the one that is there"
fi
trap 'restore; echo "The environment .venv could not be made; it is as it was." >&2' EXIT
trap 'exit 130' INT TERM HUP
echo "Installing the environment .venv$instead, which takes about a minute"
"${PYTHON:-python3}" -m venv --clear .venv
sh workflow/install.sh requirements/study.txt
# Built by the setuptools that is pinned there, not by any that an index has.
.venv/bin/pip install --quiet --no-deps --no-build-isolation --editable .
trap - EXIT
touch .venv/study.ready
rm -rf $old
