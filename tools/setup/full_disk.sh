# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
# Sourced by the scripts in tools/ that build: what compilers and linkers say of a full disk does not name it.

# full_disk: the first place a build writes to that has no room left: this folder, or that of the compiler's own files. Fails
# where all have some.
full_disk() {
    local place free
    for place in "$PWD" "${TMPDIR:-/tmp}"; do
        free=$(df --output=avail --block-size=1M "$place" 2>/dev/null | tail -n 1)
        if [[ $free =~ ^\ *[0-9]+$ ]] && ((free < 20)); then
            echo "$place"
            return 0
        fi
    done
    return 1
}

# why_build_failed GB: ends the sentence "the build failed"; where the disk is full, so many GB are needed.
why_build_failed() {
    local place
    if place=$(full_disk); then
        echo ": the disk of $place is full; make $1 GB free there and run this again, it goes on where it stopped"
    else
        echo ", see above"
    fi
}
