#!/bin/sh
# Qt's wheels bring everything but a few libraries of the system.  Look for them; install them where that is possible
# without asking, else say in one sentence what is missing.  Never fails: the command line works without a window.
set -u
[ "$(uname)" = Linux ] || exit 0

packages="libegl1 libgl1 libxkbcommon0 libdbus-1-3 libfontconfig1"
missing=""
cache=$(PATH="$PATH:/sbin:/usr/sbin" ldconfig -p 2>/dev/null)
for pair in libEGL.so.1:libegl1 libGL.so.1:libgl1 libxkbcommon.so.0:libxkbcommon0 \
            libdbus-1.so.3:libdbus-1-3 libfontconfig.so.1:libfontconfig1; do
    case "$cache" in
        *"${pair%%:*}"*) ;;
        *) missing="$missing ${pair##*:}" ;;
    esac
done
[ -n "$missing" ] || exit 0

if [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null 2>&1; then
    echo "Installing Qt's system libraries:$missing"
    apt-get update -q >/dev/null 2>&1
    # shellcheck disable=SC2086  # a list of package names
    DEBIAN_FRONTEND=noninteractive apt-get install -yq --no-install-recommends $packages xvfb >/dev/null 2>&1 && exit 0
fi
echo "The window needs system libraries that are missing here ($(echo "$missing" | sed 's/^ //; s/ /, /g'));" \
     "on Debian or Ubuntu run: sudo apt-get install$missing xvfb"
exit 0
