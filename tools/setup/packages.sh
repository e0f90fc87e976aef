# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
# Sourced from the project's root by the scripts in tools/: reads tools/packages and installs what is missing.

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

# install_packages YES SECTION...: installs what is missing, nothing else. Root needs no sudo; another user is asked before
# sudo is used, unless YES is 1. Without a terminal to ask on it says what to run and fails.
install_packages() {
    local yes=$1 missing answer
    shift
    mapfile -t missing < <(missing_packages "$@")
    if ((${#missing[@]} == 0)); then
        return 0
    fi
    local install=(apt-get install --yes --no-install-recommends "${missing[@]}")
    echo "These Debian packages are missing:"
    printf '  %s\n' "${missing[@]}"

    local as_root=()
    if ((EUID != 0)); then
        as_root=(sudo)
        if ((!yes)); then
            if [[ ! -t 0 ]]; then
                echo "error: cannot ask here whether to install them. Run this and try again, or give --yes:" >&2
                echo "  sudo apt-get update && sudo ${install[*]}" >&2
                return 1
            fi
            read -r -p "Install them with sudo apt-get? [y/N] " answer
            if [[ ! $answer =~ ^[Yy]([Ee][Ss])?$ ]]; then
                echo "Nothing was installed. The command is: sudo ${install[*]}" >&2
                return 1
            fi
        fi
        if ! command -v sudo >/dev/null; then
            echo "error: sudo is not here. As root run: apt-get update && ${install[*]}" >&2
            return 1
        fi
    fi
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get --quiet --quiet update || return 1
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive "${install[@]}"
}
