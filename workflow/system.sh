#!/bin/sh
# Have the system packages that a study needs, with "test" those of its tests too, with "slurm" a
# cluster's scheduler, with "container" what builds one: install them as root or through sudo, or say
# which.
set -eu

# Python is needed; without an engine the study goes on with the models that need none.
needed=
python=${PYTHON:-python3}
[ "$python" = python3 ] || command -v "$python" >/dev/null || {
    echo "PYTHON=$python: there is no such program" >&2
    exit 1
}
command -v "$python" >/dev/null || needed="$needed python3"
"$python" -c 'import ensurepip, venv' 2>/dev/null || needed="$needed python3-venv"
engines=
for engine in yade liggghts; do
    command -v "$engine" >/dev/null || engines="$engines $engine"
done
command -v ccx >/dev/null || engines="$engines calculix-ccx"
# The report is tested in a browser.
[ "${1-}" != test ] || command -v chromium >/dev/null || engines="$engines chromium"
if [ "${1-}" = slurm ]; then
    command -v slurmctld >/dev/null || needed="$needed slurm-wlm"
    command -v munged >/dev/null || needed="$needed munge"
fi
if [ "${1-}" = container ]; then
    command -v buildah >/dev/null || needed="$needed buildah"
    command -v debootstrap >/dev/null || needed="$needed debootstrap"
fi

install() {
    as=
    [ "$(id -u)" = 0 ] || as="sudo -n"
    command -v apt-get >/dev/null && { [ -z "$as" ] || $as true 2>/dev/null; } || return 1
    echo "Installing $*"
    $as apt-get update >/dev/null &&
        $as env DEBIAN_FRONTEND=noninteractive apt-get install --yes --no-install-recommends $* >/dev/null
}

if [ -n "$needed" ] && ! install $needed; then
    echo "Not installed; on Debian, ask for: apt-get install$needed" >&2
    exit 1
fi
for engine in $engines; do
    install "$engine" || echo "Not installed; on Debian, ask for: apt-get install $engine" >&2
done

"$python" -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null || {
    echo "$python: $("$python" -V) is too old; it must be 3.11 or newer" >&2
    exit 1
}
