// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace disparityd::web {

/// A file of page/, as it was when the program was built.
struct PageFile {
    std::string_view path;  ///< "/page.css"; of pages "/index.html", which is not where visitors find them
    std::string_view type;  ///< "text/css; charset=utf-8"
    std::string_view bytes;
};

/// Returns the file of this name, or nullptr.
const PageFile* page_file(std::string_view path);

}  // namespace disparityd::web
