# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
# Sourced by tools/package: a folder of packages that apt takes as a source.

# index_repository FOLDER: writes Packages, Packages.gz and Release for the packages that lie in it, whatever built them. What a
# reader has open meanwhile stays whole.
index_repository() {
    local folder=$1 file
    (
        cd "$folder" || exit 1
        dpkg-scanpackages --multiversion . >Packages.new 2>scan.log || { cat scan.log >&2 && exit 1; }
        rm scan.log
        gzip --keep --no-name --stdout Packages.new >Packages.gz.new
        {
            echo "Origin: disparityd"
            echo "Label: disparityd"
            echo "Date: $(LC_ALL=C date --utc '+%a, %d %b %Y %H:%M:%S +0000')"
            echo "Architectures: $(sed -n 's/^Architecture: //p' Packages.new | sort -u | paste -sd' ')"
            echo "SHA256:"
            for file in Packages Packages.gz; do
                echo " $(sha256sum <"$file.new" | cut -d' ' -f1) $(stat --format=%s "$file.new") $file"
            done
        } >Release.new
        for file in Packages Packages.gz Release; do mv "$file.new" "$file"; done
    )
}

# add_to_repository FOLDER PACKAGE...: copies them there and tells the line that makes it a source of apt.
add_to_repository() {
    local folder=$1
    shift
    mkdir -p "$folder"
    cp -- "$@" "$folder"
    chmod -R a+rX "$folder"
    index_repository "$folder" || return 1
    echo
    echo "$folder is a source for apt. To install from it: echo 'deb [trusted=yes] file:$(realpath "$folder" | sed "s/ /%20/g") ./' | sudo tee /etc/apt/sources.list.d/disparityd.list"
    echo "then sudo apt-get update && sudo apt-get install disparityd"
}
