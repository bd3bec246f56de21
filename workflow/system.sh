#!/bin/sh
# Have the system packages that a study needs: install them as root or through sudo, or say which.
set -eu

missing=
command -v python3 >/dev/null || missing="$missing python3"
python3 -c 'import ensurepip, venv' 2>/dev/null || missing="$missing python3-venv"
command -v yade >/dev/null || missing="$missing yade"

if [ -n "$missing" ]; then
    install="apt-get install --yes --no-install-recommends$missing"
    if ! command -v apt-get >/dev/null; then
        echo "multilock needs these programs, which this system lacks:$missing" >&2
        exit 1
    elif [ "$(id -u)" = 0 ]; then
        echo "Installing$missing"
        { apt-get update && DEBIAN_FRONTEND=noninteractive $install; } >/dev/null || exit 1
    elif sudo -n true 2>/dev/null; then
        echo "Installing$missing"
        { sudo -n apt-get update && sudo -n env DEBIAN_FRONTEND=noninteractive $install; } >/dev/null || exit 1
    else
        echo "multilock needs packages that this system lacks; ask for: apt-get install$missing" >&2
        exit 1
    fi
fi

python3 -c 'import sys; sys.exit(sys.version_info < (3, 11))' || {
    echo "python3: got $(python3 -V), allowed is 3.11 or newer" >&2
    exit 1
}
