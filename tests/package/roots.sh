# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
# Sourced from the project's root by the tests of packages: Debian roots that are thrown away.

# check_ready PROGRAM PACKAGES: ends it with status 2 where there are no packages, or its user may not make roots.
check_ready() {
    if ! compgen -G "$2/disparityd_*.deb" >/dev/null; then
        echo "$1: error: $2 has no disparityd_*.deb: run tools/package first" >&2
        exit 2
    fi
    if ((EUID != 0)); then
        echo "$1: error: run by user $EUID, allowed: root, who may make a Debian root and mount in it" >&2
        exit 2
    fi
}

# fresh_root ROOTS NAME PACKAGES [RELEASE]: ROOTS/NAME, a copy of a bare root of this release of Debian (default: bookworm), which is
# made once and kept beside it; in it /root/packages.
fresh_root() {
    local roots=$1 root=$1/$2 packages=$3 release=${4:-bookworm}
    local bare=$roots/bare-$release
    mkdir -p "$roots/archives"
    if [[ ! -e $bare/.complete ]]; then
        rm -rf "$bare"
        tools/setup/in-bare-root --release "$release" "$bare" true
        touch "$bare/.complete"
    fi
    rm -rf "$root"
    cp -a --reflink=auto "$bare" "$root"
    mkdir "$root/root/packages"
    cp "$packages"/*.deb "$root/root/packages"
    # What was fetched stays for the next time.
    find "$roots/archives" -name '*.deb' -exec cp -t "$root/var/cache/apt/archives" {} +
}

# keep_archives ROOTS NAME: what apt has fetched into this root is there for the next one.
keep_archives() {
    find "$1/$2/var/cache/apt/archives" -maxdepth 1 -name '*.deb' -exec mv -t "$1/archives" {} +
}
