# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
# Sourced by tools/test, which sets results (folder for outcomes), jobs and ahead (descriptor of what work_ahead says): the
# steps it is made of. A step that fails is noted and the next one runs, so that one look at the end shows everything.
source tools/setup/full_disk.sh

# took WHAT START: notes how long a step took that began at START seconds, for the table at the end.
took() { printf '%s\t%s\n' "$((SECONDS - $2))" "$1" >>"${results:?}/times.tsv"; }

# show_times: the longest first. Steps in the background wait for those in front: theirs add up to more than the whole.
show_times() {
    local seconds what
    step "times"
    while IFS=$'\t' read -r seconds what; do
        printf '%5d:%02d  %s\n' $((seconds / 60)) $((seconds % 60)) "$what"
    done < <(printf '%s\tthe whole\n' "$SECONDS"; sort -rn "${results:?}/times.tsv")
}

step() { printf '\n== %s (%d:%02d)%s\n' "$1" $((SECONDS / 60)) $((SECONDS % 60)) "$(done_so_far)"; }

# done_so_far: the steps that took a minute or more. A run that is ended from outside still tells in its last lines what took the time.
done_so_far() {
    [[ ! -e ${results:-}/times.tsv ]] || awk -F '\t' '$1 >= 60 { printf "; %s %d:%02d", $2, $1 / 60, $1 % 60 }' "$results/times.tsv"
}

# note passed|failed|skipped WHAT: the outcome of a step that is no ctest run.
note() {
    printf '%s\t%s\n' "$1" "$2" >>"${results:?}/steps.tsv"
    [[ $1 != failed ]] || echo "FAILED: $2" >&2
}

# skip WHAT: says that a step is left out, and why, at once and at the end.
skip() {
    echo "skipped: $1"
    note skipped "$1"
}

# check WHAT COMMAND...: a step that passes when the command does.
check() {
    local what=$1 start=$SECONDS
    shift
    step "$what"
    if "$@"; then note passed "$what"; else note failed "$what"; fi
    took "$what" "$start"
}

# project_sources PATTERN...: files of the project that match and are there, without build outputs.
project_sources() {
    local name
    while read -r name; do
        if [[ -e $name ]]; then echo "$name"; fi
    done < <(known_sources "$@")
}

known_sources() {
    git ls-files --cached --others --exclude-standard -- "$@" 2>/dev/null || {
        local names=() pattern
        for pattern in "$@"; do names+=(-o -name "${pattern##*/}"); done
        find . -path ./build -prune -o -type f \( "${names[@]:1}" \) -print
    }
}

# Programs of clang 14's sanitizers need addresses where they expect them; newer kernels randomise more than that.
fixed_addresses() {
    case $1 in
        asan-ubsan | tsan) if setarch -R true 2>/dev/null; then echo setarch -R; fi ;;
    esac
}

# build PRESET [CMAKE OPTION...]: notes only a failure; a build that works shows in its tests. Of a preset that is there for
# its tests, only what they start.
build() {
    local preset=$1 run targets=() start=$SECONDS
    shift
    case $preset in
        asan-ubsan | tsan | arm64) targets=(--target test-programs) ;;
        release) if ((${all:-0})); then targets=(--target all slow-test-programs); fi ;;
    esac
    read -ra run < <(fixed_addresses "$preset"; echo)
    step "build $preset"
    if ! cmake --preset "$preset" "$@" || ! "${run[@]}" cmake --build --preset "$preset" --parallel "${jobs:?}" "${targets[@]}"; then
        note failed "build $preset$(why_build_failed 3)"
        return 1
    fi
    took "build $preset" "$start"
}

# run_tests TEST-PRESET: of what is built.
run_tests() {
    local tests=$1 run start=$SECONDS
    read -ra run < <(fixed_addresses "$tests"; echo)
    step "test $tests"
    "${run[@]}" ctest --preset "$tests" --parallel "${jobs:?}" --output-junit "$results/$tests.xml" \
        --test-output-size-passed 1000000
    took "test $tests" "$start"
    [[ -s $results/$tests.xml ]] || note failed "test $tests: ctest left no result"
}

# run_fuzzers: targets for 5 s each, several at a time: with the same seed a longer run tries what was tried before. In front,
# since an input that waits for the processor looks like one that takes for ever.
run_fuzzers() {
    local outcome start=$SECONDS
    step "fuzz"
    tests/fuzz/run 5 -j "$jobs" >"$results/fuzz-run.txt" 2>&1
    outcome=$?
    took "fuzzers" "$start"
    grep '^fuzz: ' "$results/fuzz-run.txt" || cat "$results/fuzz-run.txt"
    case $outcome in
        0) note passed "fuzz" ;;
        77) note skipped "$(grep '^fuzz: skipped' "$results/fuzz-run.txt")" ;;
        *) note failed "fuzz: $(grep -m1 FAILED "$results/fuzz-run.txt")" ;;
    esac
}

build_arm64() {
    local start=$SECONDS
    step "arm64 root"
    if ! tools/setup/arm64-sysroot; then
        note failed "arm64 root"
        return 1
    fi
    took "arm64 root" "$start"
    # Kernels keep their -O3; of the rest it is only seen that it builds and is right.
    build arm64 -DDISPARITYD_WERROR=ON -DCMAKE_CXX_FLAGS_RELEASE="-O1 -DNDEBUG"
}

# compile_for_debian_13: whether the compiler of Debian 13, with its headers, takes the sources.
compile_for_debian_13() {
    local outcome said=$results/debian-13-said.txt start=$SECONDS
    step "debian 13"
    tools/setup/debian-13 -j "$jobs" 2>&1 | tee "$said"
    outcome=${PIPESTATUS[0]}
    took "debian 13" "$start"
    case $outcome in
        0) note passed "debian 13" ;;
        77) note skipped "$(grep '^debian 13: skipped' "$said")" ;;
        *) note failed "$(grep -m1 FAILED "$said" || echo "debian 13: FAILED, see above")" ;;
    esac
}

# prepare NAME: one of the steps that need no tests of the release build; debian-13 asks it how files are compiled.
prepare() {
    case $1 in
        debian-13) compile_for_debian_13 ;;
        arm64) build_arm64 ;;
        *) build "$1" ;;
    esac
}

# work_ahead NAME...: prepares them one after the other on what the tests leave of the processor: they wait a lot. Says the
# exit status of each when it is known; the rest of the output is for wait_for.
work_ahead() {
    local name
    chrt --idle --pid 0 "$BASHPID"
    for name; do
        prepare "$name" >"$results/$name.txt" 2>&1
        echo $?
    done
}

# wait_for NAME: the next that work_ahead prepares; shows its output and passes when it did. Without idle priority (ahead is
# empty) nothing was prepared, since some tests need more than an equal share of the processor.
wait_for() {
    local outcome=1
    if [[ -z ${ahead:-} ]]; then
        prepare "$1"
        return
    fi
    step "wait for $1"
    read -r outcome <&"$ahead" || note failed "$1: whatever made it has ended before its time"
    cat "$results/$1.txt"
    return "${outcome:-1}"
}

# check_format: names each file that is not formatted, and the command that mends it.
check_format() {
    local what="formatting (clang-format)" said files start=$SECONDS
    step "$what"
    if ! command -v clang-format >/dev/null; then
        skip "formatting: clang-format 14 is not installed (sudo apt-get install clang-format)"
    elif ! clang-format --version | grep -q 'version 14\.'; then
        skip "formatting: clang-format 14 is the one that counts, here is $(clang-format --version)"
    elif said=$(project_sources '*.h' '*.hpp' '*.c' '*.cpp' '*.cu' | xargs clang-format --dry-run --Werror 2>&1); then
        note passed "$what"
    else
        mapfile -t files < <(sed -n 's/:[0-9]*:[0-9]*: error: code should be clang-formatted.*//p' <<<"$said" | sort -u)
        if ((${#files[@]})); then
            printf 'not formatted: %s\n' "${files[@]}"
            note failed "formatting; to mend it: clang-format -i ${files[*]}"
        else
            echo "$said"
            note failed "$what"
        fi
    fi
    took "$what" "$start"
}

check_scripts() {
    check "shell scripts (shellcheck)" shellcheck -x tests/fuzz/run tests/package/run tests/package/lifecycle tests/package/read_frames \
        tests/package/guest tests/package/emulated tests/package/wheels tests/setup/{cuda-without-driver,like-jetpack,simulated-jetpack} \
        tools/benchmarks tools/demo tools/gpu-check tools/package tools/release tools/test tools/wheel \
        tools/cluster/{over-ssh,slurm-array} tools/setup/{arm64-sysroot,debian-13,highway,in-bare-root,wheel-root} tools/setup/*.sh .ci/run .ci/weekly debian/tests/read-frames \
        debian/*.postinst debian/*.prerm debian/*.postrm
}

# check_types: of the Python client and matcher as the release build has them, with what protoc made.
check_types() {
    check "Python types (mypy)" mypy --config-file clients/python/pyproject.toml --cache-dir build/mypy build/release/python/disparity*
}

tidy_sources() {
    project_sources '*.cpp' '*.c' | grep -v -e '^tests/' -e '^\./tests/' |
        xargs --max-args=1 --max-procs="$jobs" clang-tidy -p build/clang --quiet --warnings-as-errors='*'
}

check_tidy() { check "clang-tidy" tidy_sources; }
