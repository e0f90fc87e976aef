// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace disparityd::web {

/// A file of page/, as it was when the program was built.
struct PageFile {
    std::string_view path;  ///< "/page.css"
    std::string_view type;  ///< "text/css; charset=utf-8"
    std::string_view bytes;
};

/// Returns the file at this path of the server, or nullptr. "/" is index.html.
const PageFile* page_file(std::string_view path);

}  // namespace disparityd::web
