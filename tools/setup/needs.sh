# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
# Sourced from the project's root by the scripts in tools/: asks CMake what the project needs and does not find here, and
# installs that. What is there in any form is taken, so nothing asks dpkg for Debian's names.
source tools/setup/packages.sh

# The tab-separated lines that cmake/Needs.cmake writes: found|missing, build|test|python|gstreamer|ros2, what, packages, hint.
readonly needs_file=build/needs/needs.tsv

# missing_programs: the packages of the programs that even asking takes.
missing_programs() {
    command -v "${CXX:-c++}" >/dev/null || echo g++
    command -v "${CC:-cc}" >/dev/null || echo gcc
    command -v cmake >/dev/null || echo cmake
    command -v ninja >/dev/null || echo ninja-build
    command -v pkg-config >/dev/null || echo pkg-config
}

# cmake_fits: CMake is new enough to be asked.
cmake_fits() {
    local wanted found
    wanted=$(sed -n 's/^cmake_minimum_required(VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
    found=$(cmake --version 2>/dev/null | sed -n '1s/.*version //p')
    if ! printf '%s\n' "$wanted" "$found" | sort --check=quiet --version-sort; then
        echo "error: CMake $wanted or newer is needed; found '$found' ($(command -v cmake)). Install a newer one and run this again: docs/install.md says from where" >&2
        return 1
    fi
}

# report_needs: asks CMake, in a build folder of its own.
report_needs() {
    rm -rf build/needs  # CMake keeps what pkg-config once found
    if ! cmake -S . -B build/needs -G Ninja "-DDISPARITYD_REPORT_NEEDS=$PWD/$needs_file" >build/needs.log 2>&1 ||
        [[ ! -s $needs_file ]]; then
        tail -n 20 build/needs.log >&2
        echo "error: CMake cannot say what is missing, see above and build/needs.log (is the disk full?)" >&2
        return 1
    fi
}

# missing_needs KIND...: what is missing of build, test, python (the matcher for Python), gstreamer, ros2: "what<TAB>packages<TAB>hint".
missing_needs() {
    awk -F '\t' -v kinds=" $* " '$1 == "missing" && index(kinds, " " $2 " ") { print $3 "\t" $4 "\t" $5 }' "$needs_file"
}

# library_packages: Debian's packages of headers and libraries that the project needs, whether they are here or not.
library_packages() {
    cut -f 4 "$needs_file" | sed 's/|.*//; s/>=[^ ]*//g' | tr ' ' '\n' | grep -E '^(lib.*|cyclonedds|nlohmann-json3|pybind11)-dev$'
}

# offered PACKAGE[>=VERSION]...: whether apt has them all here, new enough.
offered() {
    local wanted candidate
    for wanted in "$@"; do
        candidate=$(apt-cache policy "${wanted%%>=*}" 2>/dev/null | awk '$1 == "Candidate:" { print $2 }')
        [[ -n $candidate && $candidate != "(none)" ]] || return 1
        [[ $wanted != *'>='* ]] || dpkg --compare-versions "$candidate" ge "${wanted##*>=}" || return 1
    done
}

# packages_for ALTERNATIVES: the first one that apt has, one package per line; fails where it has none.
packages_for() {
    local alternative names
    while IFS= read -r -d '|' alternative; do
        read -ra names <<<"$alternative"
        if offered "${names[@]}"; then
            printf '%s\n' "${names[@]%%>=*}"
            return 0
        fi
    done <<<"$1|"
    return 1
}

# tell_missing WHY: a line on standard input, as of missing_needs, is an error that says what can be done. "@" in WHY stands for
# the packages.
tell_missing() {
    local what packages hint
    while IFS=$'\t' read -r what packages hint; do
        echo "error: $what is needed, ${1/@/${packages//|/, or }}${hint:+; $hint}. docs/install.md says what else can be done" >&2
    done
}

# plan_needs KIND...: what apt brings goes to needs_packages, what it does not to needs_unknown, Highway, which can be built, to
# needs_highway.
plan_needs() {
    local what packages hint names
    while IFS=$'\t' read -r what packages hint; do
        if mapfile -t names < <(packages_for "$packages") && ((${#names[@]})); then
            needs_packages+=("${names[@]}")
        elif [[ $what == Highway* ]]; then
            needs_highway=1
        else
            needs_unknown+=("$what"$'\t'"$packages"$'\t'"$hint")
        fi
    done < <(missing_needs "$@")
}

# ensure_needs YES HIGHWAY KIND...: all of these kinds, as of missing_needs; HIGHWAY is an archive of its source or empty.
ensure_needs() {
    local yes=$1 highway=$2 programs all_missing needs_packages=() needs_unknown=() needs_highway=0
    shift 2
    mkdir -p build || return 1
    mapfile -t programs < <(missing_programs)
    if ((${#programs[@]})); then
        update_lists "$yes" && install_listed "$yes" "${programs[@]}" || return 1
    fi
    cmake_fits && report_needs || return 1
    all_missing=$(missing_needs "$@")
    [[ -n $all_missing ]] || return 0

    update_lists "$yes" || return 1
    plan_needs "$@"
    if ((${#needs_unknown[@]})) && ! compgen -G '/var/lib/apt/lists/*_Packages*' >/dev/null; then
        echo "error: apt offers nothing at all here (no network, or no sources in /etc/apt); run this again when apt-get update works" >&2
        return 1
    fi
    if ((${#needs_unknown[@]})); then
        printf '%s\n' "${needs_unknown[@]}" | tell_missing "and apt has none here that is new enough (@)"
        return 1
    fi
    if ((needs_highway)); then
        if [[ -z $highway ]] && ((!yes)); then
            confirm "Build Highway, of which apt has no version here that is new enough, from its release archive into build/deps?" \
                "give --yes, or build it with tools/setup/highway" || return 1
        fi
        if [[ -z $highway && ! -e /etc/ssl/certs/ca-certificates.crt ]]; then needs_packages+=(ca-certificates); fi
    fi
    install_listed "$yes" "${needs_packages[@]}" || return 1
    if ((needs_highway)); then
        tools/setup/highway ${highway:+--file "$highway"} || return 1
    fi
    report_needs || return 1
    all_missing=$(missing_needs "$@")
    if [[ -n $all_missing ]]; then
        tell_missing "and is not found although packages for it are installed (@)" <<<"$all_missing"
        return 1
    fi
}
