# What the project uses for its own builders, and what an installed bvhbench gives to plug-ins.
#
#   bvhbench_add_builder(NAME [SOURCE_DIR dir] [INTO target])
#
# Compiles NAME.c (and any other .c of the folder) and embeds NAME.cl if there is one. With INTO, the builder becomes a
# part of that library; without, a shared object NAME.so for `bvhbench --plugin`. The sources are the same for both: they
# define `const bb_builder bb_builder_NAME`, with '_' for each '-' of the name.

set(BVHBENCH_CMAKE_DIR ${CMAKE_CURRENT_LIST_DIR})

# Makes `variable` a C symbol that holds the texts of the files, one after the other, by way of the assembler's .incbin.
function(bvhbench_incbin output variable)
    set(parts "")
    foreach(file IN LISTS ARGN)
        string(APPEND parts "        \".incbin \\\"${file}\\\"\\n\"\n")
    endforeach()
    file(WRITE ${output}.new
"/* Embeds ${ARGN}. */
__asm__(\".section .rodata\\n\"
        \".global ${variable}\\n\"
        \".type ${variable}, @object\\n\"
        \".balign 16\\n\"
        \"${variable}:\\n\"
${parts}        \".byte 0\\n\"
        \".size ${variable}, .-${variable}\\n\"
        \".previous\\n\");
typedef int bb_translation_unit_is_not_empty;
")
    file(COPY_FILE ${output}.new ${output} ONLY_IF_DIFFERENT)
    file(REMOVE ${output}.new)
    set_source_files_properties(${output} PROPERTIES OBJECT_DEPENDS "${ARGN}")
endfunction()

function(bvhbench_write_if_changed path text)
    file(WRITE ${path}.new "${text}")
    file(COPY_FILE ${path}.new ${path} ONLY_IF_DIFFERENT)
    file(REMOVE ${path}.new)
endfunction()

function(bvhbench_add_builder name)
    cmake_parse_arguments(PARSE_ARGV 1 arg "" "SOURCE_DIR;INTO" "")
    if(NOT arg_SOURCE_DIR)
        set(arg_SOURCE_DIR ${CMAKE_CURRENT_SOURCE_DIR})
    endif()
    string(REPLACE "-" "_" symbol ${name})
    file(GLOB sources CONFIGURE_DEPENDS ${arg_SOURCE_DIR}/*.c)
    if(NOT EXISTS ${arg_SOURCE_DIR}/${name}.c)
        message(FATAL_ERROR "bvhbench_add_builder(${name}): ${arg_SOURCE_DIR} has no ${name}.c")
    endif()
    file(GLOB device CONFIGURE_DEPENDS ${arg_SOURCE_DIR}/${name}.cl)
    if(device)
        set(embedded ${CMAKE_CURRENT_BINARY_DIR}/generated/${name}_cl.c)
        bvhbench_incbin(${embedded} bb_text_${symbol}_cl ${device})
        set(described ${CMAKE_CURRENT_BINARY_DIR}/generated/${name}_source.c)
        bvhbench_write_if_changed(${described}
"#include \"framework/device/device.h\"
extern const char bb_text_${symbol}_cl[];
extern const bb_source bb_source_${symbol};
const bb_source bb_source_${symbol} = {\"${name}.cl\", bb_text_${symbol}_cl};
")
        list(APPEND sources ${embedded} ${described})
    endif()
    if(arg_INTO)
        target_sources(${arg_INTO} PRIVATE ${sources})
        set_property(TARGET ${arg_INTO} APPEND PROPERTY BVHBENCH_BUILDERS ${symbol})
    else()
        set(exported ${CMAKE_CURRENT_BINARY_DIR}/generated/${name}_plugin.c)
        bvhbench_write_if_changed(${exported}
"#include \"framework/builder/builder.h\"
extern const bb_builder bb_builder_${symbol};
BB_PLUGIN(bb_builder_${symbol});
")
        add_library(${name} MODULE ${sources} ${exported})
        set_target_properties(${name} PROPERTIES PREFIX "" C_STANDARD 11 C_STANDARD_REQUIRED ON
                              C_VISIBILITY_PRESET hidden)
        target_link_libraries(${name} PRIVATE bvhbench::bvhbench)
        target_compile_options(${name} PRIVATE -ffp-contract=off)
    endif()
endfunction()

# ---- for the project's own build ----

function(bvhbench_generate_builder_table target)
    get_target_property(names ${target} BVHBENCH_BUILDERS)
    list(SORT names)
    set(text "#include \"framework/builder/builder.h\"\n")
    foreach(name IN LISTS names)
        string(APPEND text "extern const bb_builder bb_builder_${name};\n")
    endforeach()
    string(APPEND text "const bb_builder *const bb_builtin_builders[] = {\n")
    foreach(name IN LISTS names)
        string(APPEND text "    &bb_builder_${name},\n")
    endforeach()
    string(APPEND text "    0,\n};\n")
    bvhbench_write_if_changed(${CMAKE_CURRENT_BINARY_DIR}/generated/builders.c "${text}")
    target_sources(${target} PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/generated/builders.c)
endfunction()

# A table of pointers to `type type_NAME`, one for each PREFIX_NAME.c that matches `pattern`.
function(bvhbench_generate_table target pattern type table header)
    file(GLOB files CONFIGURE_DEPENDS ${pattern})
    list(SORT files)
    set(text "#include \"${header}\"\n")
    set(rows "")
    foreach(file IN LISTS files)
        get_filename_component(stem ${file} NAME_WE)
        string(REGEX REPLACE "^[a-z]+_(.*)$" "\\1" name ${stem})
        string(APPEND text "extern const ${type} ${type}_${name};\n")
        string(APPEND rows "    &${type}_${name},\n")
    endforeach()
    string(APPEND text "const ${type} *const ${table}[] = {\n${rows}    0,\n};\n")
    bvhbench_write_if_changed(${CMAKE_CURRENT_BINARY_DIR}/generated/${table}.c "${text}")
    target_sources(${target} PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/generated/${table}.c)
endfunction()

# bb_embedded_sources[]: every device source and header by its file name.
function(bvhbench_embed_sources target)
    set(text "#include \"framework/device/device.h\"\n")
    set(rows "")
    foreach(file IN LISTS ARGN)
        get_filename_component(name ${file} NAME)
        string(MAKE_C_IDENTIFIER ${name} symbol)
        set(output ${CMAKE_CURRENT_BINARY_DIR}/generated/embedded_${symbol}.c)
        bvhbench_incbin(${output} bb_text_${symbol} ${file})
        target_sources(${target} PRIVATE ${output})
        string(APPEND text "extern const char bb_text_${symbol}[];\n")
        string(APPEND rows "    {\"${name}\", bb_text_${symbol}},\n")
    endforeach()
    string(APPEND text "const bb_source bb_embedded_sources[] = {\n${rows}    {0, 0},\n};\n")
    bvhbench_write_if_changed(${CMAKE_CURRENT_BINARY_DIR}/generated/embedded_sources.c "${text}")
    target_sources(${target} PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/generated/embedded_sources.c)
endfunction()

# The report page's template and the chart library (Debian's libjs-chart.js), embedded.
function(bvhbench_embed_report target)
    find_file(CHART_JS NAMES chart.min.js Chart.min.js chart.js Chart.js
              PATHS /usr/share/javascript/chart.js /usr/share/javascript/chartjs
                    /usr/share/nodejs/chart.js/dist NO_DEFAULT_PATH REQUIRED)
    set(output ${CMAKE_CURRENT_BINARY_DIR}/generated/embedded_chart_js.c)
    bvhbench_incbin(${output} bb_text_chart_js ${CHART_JS})
    target_sources(${target} PRIVATE ${output})
    # The script in parts, in this order: what a part uses stands in it or before it.
    set(html report.html)
    set(css report.css)
    set(js data.js series.js draw.js tables.js charts.js page.js)
    foreach(part html css js)
        list(TRANSFORM ${part} PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/framework/report/page/)
        set(output ${CMAKE_CURRENT_BINARY_DIR}/generated/embedded_report_${part}.c)
        bvhbench_incbin(${output} bb_text_report_${part} ${${part}})
        target_sources(${target} PRIVATE ${output})
    endforeach()
endfunction()

# Revision, version and flags, as they are at build time.
function(bvhbench_build_info target)
    string(TOUPPER "${CMAKE_BUILD_TYPE}" type)
    get_directory_property(options COMPILE_OPTIONS)
    list(FILTER options EXCLUDE REGEX "^-W") # warnings change no code
    string(JOIN " " flags ${CMAKE_BUILD_TYPE} ${CMAKE_C_FLAGS} ${CMAKE_C_FLAGS_${type}} ${options})
    file(RELATIVE_PATH libdir_to_datadir ${CMAKE_INSTALL_FULL_LIBDIR} ${CMAKE_INSTALL_FULL_DATADIR})
    add_custom_target(bvhbench-build-info
        COMMAND ${CMAKE_COMMAND} -DSOURCE=${CMAKE_CURRENT_SOURCE_DIR}
                -DOUTPUT=${CMAKE_CURRENT_BINARY_DIR}/generated/build_info.c
                "-DFLAGS=${flags}"
                -DVERSION=${PROJECT_VERSION}
                -DCOMPILER=${CMAKE_C_COMPILER_ID}-${CMAKE_C_COMPILER_VERSION}
                -P ${BVHBENCH_CMAKE_DIR}/build_info.cmake
        BYPRODUCTS ${CMAKE_CURRENT_BINARY_DIR}/generated/build_info.c)
    target_sources(${target} PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/generated/build_info.c)
    add_dependencies(${target} bvhbench-build-info)
    target_compile_definitions(${target} PRIVATE
        BB_SOURCE_DIR="${CMAKE_CURRENT_SOURCE_DIR}"
        BB_INSTALL_PREFIX="${CMAKE_INSTALL_PREFIX}"
        BB_LIBDIR="${CMAKE_INSTALL_LIBDIR}" BB_LIBDIR_TO_DATADIR="${libdir_to_datadir}")
endfunction()
