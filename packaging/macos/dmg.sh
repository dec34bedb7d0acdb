#!/bin/sh
# Make the disk image of the application that `python packaging/bundle.py` has made; run on macOS.
# KIRIGAMI_SIGN_IDENTITY: name of a "Developer ID Application" certificate; set it for bundle.py, too.
# KIRIGAMI_NOTARY_PROFILE: what `xcrun notarytool store-credentials` was given as the profile's name.
# Without them the image is not signed, and macOS asks before the program is opened for the first time.
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
application="$root/build/bundle/dist/Kirigami Studio.app"
image="$root/dist/$(python3 "$root/packaging/version.py" | grep '\.dmg$')"
[ -d "$application" ] || { echo "Run packaging/bundle.py first."; exit 1; }

if [ -n "${KIRIGAMI_SIGN_IDENTITY:-}" ]; then
    codesign --verify --deep --strict "$application"
fi
stage=$(mktemp -d)
trap 'rm -rf "$stage"' EXIT
cp -R "$application" "$stage/"
ln -s /Applications "$stage/Applications"
mkdir -p "$root/dist"
hdiutil create -volname "Kirigami Studio" -srcfolder "$stage" -fs HFS+ -format ULMO -ov "$image"

if [ -n "${KIRIGAMI_SIGN_IDENTITY:-}" ]; then
    codesign --sign "$KIRIGAMI_SIGN_IDENTITY" --timestamp "$image"
fi
if [ -n "${KIRIGAMI_NOTARY_PROFILE:-}" ]; then
    xcrun notarytool submit "$image" --keychain-profile "$KIRIGAMI_NOTARY_PROFILE" --wait
    xcrun stapler staple "$image"
fi
echo "$image"
