// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/colour_argument.h"

#include "tools/command_line/number_argument.h"

namespace disparityd::tools {

CLI::Option* add_colour_range(CLI::App& app, std::string& word) {
    return add_choice(app, "--colour-range", word, {"searched", "frame"},
                      "disparities that the colours span: searched (default), so that pictures can be compared, or "
                      "frame, for more contrast");
}

images::ColourRange colour_range(const std::string& word) {
    return word == "frame" ? images::ColourRange::frame : images::ColourRange::searched;
}

}  // namespace disparityd::tools
