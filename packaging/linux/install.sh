#!/bin/sh
# Install the unpacked archive that this file lies in, with menu entry, icons and file type, or remove it again.
# usage: install.sh [--remove] [PREFIX]       (PREFIX: ~/.local unless given)
set -eu
here=$(cd "$(dirname "$0")" && pwd)
remove=""
if [ "${1:-}" = --remove ]; then remove=yes; shift; fi
prefix=${1:-$HOME/.local}
home=$prefix/lib/kirigami-studio

refresh() {
    # What is not there is not needed: the desktop then reads the files themselves.
    update-mime-database "$prefix/share/mime" >/dev/null 2>&1 || true
    update-desktop-database "$prefix/share/applications" >/dev/null 2>&1 || true
    gtk-update-icon-cache -qt "$prefix/share/icons/hicolor" >/dev/null 2>&1 || true
}

if [ -n "$remove" ]; then
    [ -f "$home/install.sh" ] || { echo "There is no Kirigami Studio in $prefix."; exit 1; }
    (cd "$home/share" && find . -type f) | while read -r file; do rm -f "$prefix/share/$file"; done
    rm -f "$prefix/bin/kirigami-studio"
    rm -rf "$home"
    refresh
    echo "Removed. Settings stay in ~/.config/kirigami-studio."
    exit 0
fi

[ "$here" != "$home" ] || { echo "This is the installed program; run install.sh of an unpacked archive."; exit 1; }
mkdir -p "$prefix/lib" "$prefix/bin" "$prefix/share"
rm -rf "$home"
cp -a "$here" "$home"
ln -sfn "$home/kirigami-studio" "$prefix/bin/kirigami-studio"
cp -R "$home/share/." "$prefix/share/"
# A desktop need not have PREFIX/bin among its commands.
sed -i "s|^Exec=kirigami-studio|Exec=\"$prefix/bin/kirigami-studio\"|; /^TryExec=/d" "$prefix/share/applications/kirigami-studio.desktop"
refresh
echo "Installed in $prefix. Start it from the menu, or with $prefix/bin/kirigami-studio"
