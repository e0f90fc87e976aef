# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
# Sourced from the project's root by the scripts in tools/: reads tools/packages and installs what is missing, as root or with
# sudo. A second run goes on where the first one stopped.

# packages_of SECTION...: the packages of these sections, one per line.
packages_of() {
    awk -v wanted=" $* " '
        { sub(/#.*/, "") }
        /^\[.*\]/ { gsub(/[][ \t]/, ""); section = $0; next }
        NF && index(wanted, " " section " ") { print $1 }' tools/packages
}

# missing_packages SECTION...: those of them that are not installed, one per line.
missing_packages() {
    local package
    while read -r package; do
        if [[ $(dpkg-query --show --showformat '${db:Status-Abbrev}' "$package" 2>/dev/null) != ii* ]]; then
            echo "$package"
        fi
    done < <(packages_of "$@")
}

# confirm QUESTION OTHERWISE: asks on the terminal; where there is none it says what else to do, and fails.
confirm() {
    local answer
    if [[ ! -t 0 ]]; then
        echo "error: cannot ask here: $1 To go on, $2" >&2
        return 1
    fi
    read -r -p "$1 [y/N] " answer
    if [[ ! $answer =~ ^[Yy]([Ee][Ss])?$ ]]; then
        echo "Nothing was done. To go on, $2" >&2
        return 1
    fi
}

# as_root YES COMMAND...: root needs no sudo; another user is asked once before it is used, unless YES is 1. What it refuses
# itself it tells in a line that is enough, and returns so.
readonly told=99
sudo_allowed=0
as_root() {
    local yes=$1
    shift
    if ((EUID == 0)); then
        "$@"
        return
    fi
    if ! command -v sudo >/dev/null; then
        echo "error: packages are missing and sudo is not here; run this as root, or as root: $*" >&2
        return "$told"
    fi
    if ((!yes && !sudo_allowed)); then
        confirm "Install what is missing with sudo apt-get?" "run: sudo apt-get update && sudo $*, or give --yes" || return "$told"
        sudo_allowed=1
    fi
    sudo "$@"
}

# apt YES ARGUMENT...: apt-get, which waits for another one that holds its lock.
apt() {
    local yes=$1
    shift
    as_root "$yes" env DEBIAN_FRONTEND=noninteractive apt-get -o DPkg::Lock::Timeout=300 --quiet --quiet "$@"
}

# tell_failure LINE COMMAND...: runs it; where it fails without having told why, the line does.
tell_failure() {
    local line=$1 outcome
    shift
    "$@"
    outcome=$?
    if ((outcome != 0 && outcome != told)); then echo "$line" >&2; fi
    return "$outcome"
}

# update_lists YES: what apt knows, once in a run.
lists_updated=0
update_lists() {
    ((!lists_updated)) || return 0
    tell_failure "error: apt-get update failed, see above (no network? no right to use sudo?); run this again when it works" \
        apt "$1" update || return 1
    lists_updated=1
}

# install_listed YES PACKAGE...: installs these.
install_listed() {
    local yes=$1
    shift
    (($#)) || return 0
    echo "These packages are missing:"
    printf '  %s\n' "$@"
    tell_failure "error: apt-get could not install them, see above (another package manager at work? disk full? no network?); run this again when it can" \
        apt "$yes" install --yes --no-install-recommends "$@"
}

# install_packages YES SECTION...: installs what is missing of these sections of tools/packages, nothing else.
install_packages() {
    local yes=$1 missing
    shift
    mapfile -t missing < <(missing_packages "$@")
    ((${#missing[@]})) || return 0
    update_lists "$yes" && install_listed "$yes" "${missing[@]}"
}
