#!/bin/sh
# Make the environment .venv anew, from requirements.txt and this project. An environment has its own
# path in its programs, so it is made in its place; the one that was there comes back if that fails.
set -eu
old=.venv.old

restore() {
    [ -d $old ] || return 0
    rm -rf .venv
    mv $old .venv
}

restore # of a try that was killed
[ ! -d .venv ] || mv .venv $old
trap 'restore; echo "The environment .venv could not be made; it is as it was." >&2' EXIT
trap 'exit 130' INT TERM HUP
python3 -m venv --clear .venv
sh workflow/install.sh requirements.txt
# Built by the setuptools that is pinned there, not by any that an index has.
.venv/bin/pip install --quiet --no-deps --no-build-isolation --editable .
trap - EXIT
touch .venv/study.ready
rm -rf $old
