# SPDX-License-Identifier: Apache-2.0
# cmake -D FILES=a;b -D OUTPUT=page_files.cpp -P embed_page.cmake: writes the files as C++.
set(types_css "text/css; charset=utf-8")
set(types_html "text/html; charset=utf-8")
set(types_js "text/javascript; charset=utf-8")
set(types_svg "image/svg+xml")

set(arrays "")
set(entries "")
set(number 0)
foreach(path IN LISTS FILES)
  get_filename_component(name ${path} NAME)
  string(REGEX MATCH "[^.]*$" ending ${name})
  if(NOT types_${ending})
    message(FATAL_ERROR "${path}: no type is known for files that end in .${ending}; add it to embed_page.cmake")
  endif()
  file(READ ${path} hex HEX)
  string(REGEX REPLACE "(..)" "0x\\1," bytes "${hex}")
  string(APPEND arrays "constexpr unsigned char bytes_${number}[] = {${bytes}0};\n")
  string(APPEND entries "    {\"/${name}\", \"${types_${ending}}\", view(bytes_${number}, sizeof bytes_${number} - 1)},\n")
  math(EXPR number "${number} + 1")
endforeach()
file(WRITE ${OUTPUT} "// Written by embed_page.cmake.
#include \"bridges/web/http/page_files.h\"

#include <array>
#include <cstddef>

namespace disparityd::web {
namespace {

${arrays}
std::string_view view(const unsigned char* bytes, std::size_t size) {
    return {reinterpret_cast<const char*>(bytes), size};
}

}  // namespace

const PageFile* page_file(std::string_view path) {
    static const std::array<PageFile, ${number}> files{{
${entries}    }};
    for (const PageFile& file : files) {
        if (file.path == path) {
            return &file;
        }
    }
    return nullptr;
}

}  // namespace disparityd::web
")
