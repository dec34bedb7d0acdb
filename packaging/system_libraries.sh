#!/bin/sh
# Qt's wheels need a few system libraries.  Install those that are missing if that is possible without asking, else
# print the command that does.  Never fails: the command line works without a window.
# With the argument "tests", also look for the programs that some tests use; those tests are skipped without them.
set -u
[ "$(uname)" = Linux ] || exit 0

# From libxcb-cursor on: what the window needs on an X display; Qt does not start if one of them is missing.
missing="" files=""
cache=$(PATH="$PATH:/sbin:/usr/sbin" ldconfig -p 2>/dev/null)
for pair in libEGL.so.1:libegl1 libGL.so.1:libgl1 libxkbcommon.so.0:libxkbcommon0 \
            libdbus-1.so.3:libdbus-1-3 libfontconfig.so.1:libfontconfig1 \
            libxcb-cursor.so.0:libxcb-cursor0 libxcb-icccm.so.4:libxcb-icccm4 libxcb-image.so.0:libxcb-image0 \
            libxcb-keysyms.so.1:libxcb-keysyms1 libxcb-randr.so.0:libxcb-randr0 \
            libxcb-render-util.so.0:libxcb-render-util0 libxcb-shape.so.0:libxcb-shape0 libxcb-sync.so.1:libxcb-sync1 \
            libxcb-xfixes.so.0:libxcb-xfixes0 libxcb-xkb.so.1:libxcb-xkb1 libxkbcommon-x11.so.0:libxkbcommon-x11-0; do
    case "$cache" in
        *"${pair%%:*}"*) ;;
        *) missing="$missing ${pair##*:}" files="$files ${pair%%:*}" ;;
    esac
done
if [ "${1:-}" = tests ]; then
    for pair in Xvfb:xvfb xdotool:xdotool; do
        command -v "${pair%%:*}" >/dev/null 2>&1 || { missing="$missing ${pair##*:}"; files="$files ${pair%%:*}"; }
    done
    # A screen reader's view: a bus, the registry on it, and its bindings for the system's Python.
    command -v dbus-daemon >/dev/null 2>&1 || { missing="$missing dbus"; files="$files dbus-daemon"; }
    [ -e /usr/share/dbus-1/services/org.a11y.Bus.service ] || { missing="$missing at-spi2-core"; files="$files org.a11y.Bus"; }
    /usr/bin/python3 -c 'import gi; gi.require_version("Atspi", "2.0")' >/dev/null 2>&1 \
        || { missing="$missing python3-gi gir1.2-atspi-2.0"; files="$files Atspi-2.0.typelib"; }
fi
[ -n "$missing" ] || exit 0

if [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null 2>&1; then
    echo "Installing system packages for the window:$missing"
    apt-get update -q >/dev/null 2>&1
    # shellcheck disable=SC2086  # a list of package names
    DEBIAN_FRONTEND=noninteractive apt-get install -yq --no-install-recommends $missing xvfb >/dev/null 2>&1 && exit 0
fi
if command -v apt-get >/dev/null 2>&1; then
    echo "System packages for the window${1:+ and its $1} are missing:$missing." \
         "Run: sudo apt-get install$missing xvfb"
else
    echo "The window${1:+ and its $1} need files that this system lacks, and there is no apt-get to install them:$files." \
         "Install the packages of your system that hold them; on Debian and Ubuntu they are called$missing."
fi
exit 0
