# What the checks of recorded programs share (record.sh): the compiler, and a program's options.

# Sets `clang` to the first of the major versions given that is here with libclc: of one version,
# since libclc is bitcode.
find_clang() {
    local state
    for clang in "$@"; do
        state=$(dpkg-query -W -f '${db:Status-Status}' "libclc-$clang" 2>/dev/null || true)
        ! command -v "clang-$clang" >/dev/null || [ "$state" != installed ] || return 0
    done
    return 1
}

# The options that a program was built with, without -cl-std, and without one that not all clangs
# know and that changes no more than how exactly it divides.
options_of() {
    sed -n '1 {
        s,^// options: ,,
        s/-cl-std=[^ ]*//
        s/-cl-fp32-correctly-rounded-divide-sqrt//
        p
    }' "$1"
}

# Each recorded program under the folders given, once.
programs_in() {
    find "$@" -name '*.cl' | awk -F/ '!seen[$NF]++' | sort
}
