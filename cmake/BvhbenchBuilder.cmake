# CMake functions for the project's own builders and, from an installed bvhbench, for plug-ins.
#
#   bvhbench_add_builder(NAME [SOURCE_DIR dir] [INTO target])
#
# Compiles NAME.c and any other .c of the folder, and embeds its device files: all .cl and .clh, and
# the headers NAME_shared.h that host and device share; and NAME.bib, the papers. With INTO, the builder becomes part of that
# library; without, a shared object NAME.so for `bvhbench --plugin`. The sources are the same for
# both: they define `const bb_builder bb_builder_NAME`, with '_' for each '-' of the name.
#
#   bvhbench_add_tracer(NAME [SOURCE_DIR dir] [INTO target])
#
# The same for a tracer: all .c and .cpp files of the folder, which define
# `const bb_tracer bb_tracer_NAME`; in C++, which is C++20, `extern "C" const bb_tracer ...`: a
# constant is seen by its own file alone otherwise. Its target is NAME: add a library's include
# folders and flags to it.

set(BVHBENCH_CMAKE_DIR ${CMAKE_CURRENT_LIST_DIR})

# Flags for all code of the project, and for plug-ins. They give the same float results on every
# compiler: no contraction, no relaxed math.
set(BVHBENCH_COMPILE_OPTIONS -Wall -Wextra -Wpedantic -ffp-contract=off)
set(BVHBENCH_COMPILE_DEFINITIONS _GNU_SOURCE)
set(BVHBENCH_LANGUAGE_PROPERTIES
    C_STANDARD 11 C_STANDARD_REQUIRED ON C_EXTENSIONS OFF C_VISIBILITY_PRESET hidden
    CXX_STANDARD 17 CXX_STANDARD_REQUIRED ON CXX_EXTENSIONS OFF CXX_VISIBILITY_PRESET hidden
    VISIBILITY_INLINES_HIDDEN ON)

# Makes these properties the defaults of all later targets.
macro(bvhbench_language)
    set(bvhbench_properties ${ARGN})
    while(bvhbench_properties)
        list(POP_FRONT bvhbench_properties bvhbench_property bvhbench_value)
        set(CMAKE_${bvhbench_property} ${bvhbench_value})
    endwhile()
endmacro()

# Makes `variable` a C symbol that contains the texts of the files, one after the other, by the
# assembler's .incbin.
function(bvhbench_incbin output variable)
    set(parts "")
    foreach(file IN LISTS ARGN)
        string(APPEND parts "        \".incbin \\\"${file}\\\"\\n\"\n")
    endforeach()
    file(WRITE ${output}.new
"/* Embeds ${ARGN}. */
__asm__(\".section .rodata\\n\"
        \".global ${variable}\\n\"
        \".hidden ${variable}\\n\"
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

# `text`: declarations and rows of a table of bb_source for device files, which `target` embeds.
# `folder`: the C name of that table, 0 for none. A file's name is unique within the target; loading
# checks it between plug-ins.
function(bvhbench_embed_device_files target folder text rows)
    set(declarations "")
    set(table "")
    foreach(file IN LISTS ARGN)
        get_filename_component(name ${file} NAME)
        string(MAKE_C_IDENTIFIER ${name} symbol)
        get_target_property(other ${target} BVHBENCH_DEVICE_FILE_${symbol})
        if(other AND NOT other STREQUAL file)
            message(FATAL_ERROR "two device files of one name, ${other} and ${file}: rename one")
        endif()
        set_property(TARGET ${target} PROPERTY BVHBENCH_DEVICE_FILE_${symbol} ${file})
        set(output ${CMAKE_CURRENT_BINARY_DIR}/generated/${target}/embedded_${symbol}.c)
        bvhbench_incbin(${output} bb_text_${symbol} ${file})
        target_sources(${target} PRIVATE ${output})
        string(APPEND declarations "extern const char bb_text_${symbol}[];\n")
        string(APPEND table "    {\"${name}\", bb_text_${symbol}, ${folder}},\n")
    endforeach()
    set(${text} "${declarations}" PARENT_SCOPE)
    set(${rows} "${table}" PARENT_SCOPE)
endfunction()

# The device files of a builder's folder as bb_files_SYMBOL, and each FILE.cl as bb_source_FILE.
function(bvhbench_embed_folder target symbol folder)
    file(GLOB files CONFIGURE_DEPENDS ${folder}/*.cl ${folder}/*.clh ${folder}/*_shared.h
         ${folder}/*.bib)
    bvhbench_embed_device_files(${target} bb_files_${symbol} declarations rows ${files})
    set(sources "")
    list(FILTER files INCLUDE REGEX "\\.cl$")
    foreach(file IN LISTS files)
        get_filename_component(name ${file} NAME)
        string(MAKE_C_IDENTIFIER ${name} text)
        string(REGEX REPLACE "_cl$" "" source ${text})
        string(APPEND sources "extern const bb_source bb_source_${source};
const bb_source bb_source_${source} = {\"${name}\", bb_text_${text}, bb_files_${symbol}};
")
    endforeach()
    set(described ${CMAKE_CURRENT_BINARY_DIR}/generated/${symbol}_files.c)
    bvhbench_write_if_changed(${described}
"#include \"framework/device/device.h\"
${declarations}extern const bb_source bb_files_${symbol}[];
const bb_source bb_files_${symbol}[] = {
${rows}    {0, 0, 0},
};
${sources}")
    target_sources(${target} PRIVATE ${described})
endfunction()

# NAME.so of these sources.
function(bvhbench_add_plugin name)
    add_library(${name} MODULE ${ARGN})
    set_target_properties(${name} PROPERTIES PREFIX "" ${BVHBENCH_LANGUAGE_PROPERTIES})
    target_link_libraries(${name} PRIVATE bvhbench::bvhbench)
    target_compile_definitions(${name} PRIVATE ${BVHBENCH_COMPILE_DEFINITIONS})
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
    if(arg_INTO)
        target_sources(${arg_INTO} PRIVATE ${sources})
        bvhbench_embed_folder(${arg_INTO} ${symbol} ${arg_SOURCE_DIR})
        set_property(TARGET ${arg_INTO} APPEND PROPERTY BVHBENCH_BUILDERS ${symbol})
    else()
        set(exported ${CMAKE_CURRENT_BINARY_DIR}/generated/${name}_plugin.c)
        bvhbench_write_if_changed(${exported}
"#include \"framework/builder/builder.h\"
extern const bb_builder bb_builder_${symbol};
extern const bb_source bb_files_${symbol}[];
BB_PLUGIN(bb_builder_${symbol}, bb_files_${symbol});
")
        bvhbench_add_plugin(${name} ${sources} ${exported})
        bvhbench_embed_folder(${name} ${symbol} ${arg_SOURCE_DIR})
        target_compile_options(${name} PRIVATE ${BVHBENCH_COMPILE_OPTIONS})
    endif()
endfunction()

function(bvhbench_add_tracer name)
    cmake_parse_arguments(PARSE_ARGV 1 arg "" "SOURCE_DIR;INTO" "")
    if(NOT arg_SOURCE_DIR)
        set(arg_SOURCE_DIR ${CMAKE_CURRENT_SOURCE_DIR})
    endif()
    string(REPLACE "-" "_" symbol ${name})
    file(GLOB sources CONFIGURE_DEPENDS ${arg_SOURCE_DIR}/*.c ${arg_SOURCE_DIR}/*.cpp)
    if(NOT sources)
        message(FATAL_ERROR "bvhbench_add_tracer(${name}): ${arg_SOURCE_DIR} has no .c and no .cpp file")
    endif()
    if(arg_INTO)
        target_sources(${arg_INTO} PRIVATE ${sources})
        set_property(TARGET ${arg_INTO} APPEND PROPERTY BVHBENCH_TRACERS ${symbol})
    else()
        set(exported ${CMAKE_CURRENT_BINARY_DIR}/generated/${name}_plugin.c)
        bvhbench_write_if_changed(${exported}
"#include \"framework/builder/tracer.h\"
extern const bb_tracer bb_tracer_${symbol};
BB_TRACER_PLUGIN(bb_tracer_${symbol});
")
        bvhbench_add_plugin(${name} ${sources} ${exported})
        set_target_properties(${name} PROPERTIES CXX_STANDARD 20)
    endif()
endfunction()

# ---- for the project's own build ----

function(bvhbench_generate_tracer_table target)
    get_target_property(names ${target} BVHBENCH_TRACERS)
    list(SORT names)
    set(text "#include \"framework/builder/tracers.h\"\n")
    set(rows "")
    foreach(name IN LISTS names)
        string(APPEND text "extern const bb_tracer bb_tracer_${name};\n")
        string(APPEND rows "    &bb_tracer_${name},\n")
    endforeach()
    string(APPEND text "const bb_tracer *const bb_builtin_tracers[] = {\n${rows}    0,\n};\n")
    bvhbench_write_if_changed(${CMAKE_CURRENT_BINARY_DIR}/generated/tracers.c "${text}")
    target_sources(${target} PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/generated/tracers.c)
endfunction()

function(bvhbench_generate_builder_table target)
    get_target_property(names ${target} BVHBENCH_BUILDERS)
    list(SORT names)
    set(text "#include \"framework/builder/registry.h\"\n")
    set(rows "")
    foreach(name IN LISTS names)
        string(APPEND text "extern const bb_builder bb_builder_${name};\n"
                           "extern const bb_source bb_files_${name}[];\n")
        string(APPEND rows "    {BB_PLUGIN_MAGIC, BB_ABI_VERSION, sizeof(bb_registration),\n"
                           "     &bb_builder_${name}, bb_files_${name}},\n")
    endforeach()
    string(APPEND text "const bb_registration bb_builtin_builders[] = {\n${rows}    {.builder = 0},\n};\n")
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

# bb_embedded_sources[]: the device files of kernels/ and builders/common by name.
function(bvhbench_embed_sources target)
    bvhbench_embed_device_files(${target} 0 declarations rows ${ARGN})
    set(output ${CMAKE_CURRENT_BINARY_DIR}/generated/embedded_sources.c)
    bvhbench_write_if_changed(${output}
"#include \"framework/device/device_private.h\"
${declarations}const bb_source bb_embedded_sources[] = {
${rows}    {0, 0, 0},
};
")
    target_sources(${target} PRIVATE ${output})
endfunction()

# The report page's template and the chart library (Debian's libjs-chart.js), embedded.
function(bvhbench_embed_report target)
    find_file(CHART_JS NAMES chart.min.js Chart.min.js chart.js Chart.js
              PATHS /usr/share/javascript/chart.js /usr/share/javascript/chartjs
                    /usr/share/nodejs/chart.js/dist NO_DEFAULT_PATH REQUIRED)
    set(output ${CMAKE_CURRENT_BINARY_DIR}/generated/embedded_chart_js.c)
    bvhbench_incbin(${output} bb_text_chart_js ${CHART_JS})
    target_sources(${target} PRIVATE ${output})
    # Parts of scripts, in this order: a part only uses itself and earlier parts.
    set(shown ../../table/page)
    set(report_html ${shown}/head.html report.html)
    set(report_js ${shown}/dom.js ${shown}/figure.js ${shown}/sort.js ${shown}/svg.js ${shown}/download.js data.js commands.js series.js emphasis.js draw.js tables.js charts.js verdict.js predict.js against.js page.js)
    set(report_history_html ${shown}/head.html history.html) # a page of its own
    set(report_history_js ${shown}/dom.js ${shown}/figure.js history.js)
    set(atlas_html ${shown}/head.html atlas.html) # another
    set(atlas_js ${shown}/dom.js atlas.js)
    set(style_css ${shown}/style.css)
    set(page_html ${shown}/head.html ${shown}/page.html) # of framework/table
    set(page_js dom.js figure.js sort.js svg.js download.js grid.js axis.js plot.js blocks.js)
    list(TRANSFORM page_js PREPEND ${shown}/)
    foreach(part style_css page_html page_js report_html report_js report_history_html report_history_js atlas_html
                 atlas_js)
        list(TRANSFORM ${part} PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/framework/report/page/)
        set(output ${CMAKE_CURRENT_BINARY_DIR}/generated/embedded_${part}.c)
        bvhbench_incbin(${output} bb_text_${part} ${${part}})
        target_sources(${target} PRIVATE ${output})
    endforeach()
endfunction()

# bb_axis_sources[]: the axes of `bvhbench stress`, embedded.
function(bvhbench_embed_axes target)
    file(GLOB files CONFIGURE_DEPENDS framework/stress/axes/*.json)
    set(declarations "")
    set(table "")
    foreach(file IN LISTS files)
        get_filename_component(name ${file} NAME_WE)
        string(MAKE_C_IDENTIFIER axis_${name} symbol)
        set(output ${CMAKE_CURRENT_BINARY_DIR}/generated/embedded_${symbol}.c)
        bvhbench_incbin(${output} bb_text_${symbol} ${file})
        target_sources(${target} PRIVATE ${output})
        string(APPEND declarations "extern const char bb_text_${symbol}[];\n")
        string(APPEND table "    {\"${name}\", bb_text_${symbol}},\n")
    endforeach()
    set(output ${CMAKE_CURRENT_BINARY_DIR}/generated/axes.c)
    bvhbench_write_if_changed(${output}
"#include \"framework/stress/axis.h\"
${declarations}const bb_axis_source bb_axis_sources[] = {
${table}    {0, 0},
};
")
    target_sources(${target} PRIVATE ${output})
endfunction()

# Revision, version and flags at build time.
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
