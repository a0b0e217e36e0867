# Writes the revision of the working tree and the flags of the build into a C file, if they changed.
execute_process(COMMAND git -C ${SOURCE} describe --always --dirty --abbrev=12
                OUTPUT_VARIABLE revision OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET
                RESULT_VARIABLE failed)
if(failed OR NOT revision)
    set(revision "${VERSION}")
endif()
file(WRITE ${OUTPUT}.new
"extern const char bb_build_revision[], bb_build_version[], bb_build_flags[];
const char bb_build_revision[] = \"${revision}\";
const char bb_build_version[] = \"${VERSION}\";
const char bb_build_flags[] = \"${COMPILER} ${FLAGS}\";
")
file(COPY_FILE ${OUTPUT}.new ${OUTPUT} ONLY_IF_DIFFERENT)
file(REMOVE ${OUTPUT}.new)
