// SPDX-License-Identifier: Apache-2.0
#include "calibration/formats/yaml_text.h"

#include <algorithm>
#include <set>

#include "base/message_text.h"
#include "base/words.h"
#include "calibration/formats/calibration_formats.h"

namespace disparityd::calibration {

namespace {

/// Returns the text with an empty line in place of "%YAML...". JSON may be indented with tabs, YAML may not.
std::string without_header(std::string_view text) {
    std::string result(text);
    if (result.starts_with("%YAML")) {
        result.erase(0, result.find('\n'));
    }
    if (base::trim(result).starts_with('{')) {
        std::replace(result.begin(), result.end(), '\t', ' ');
    }
    return result;
}

}  // namespace

YAML::Node read_yaml_map(const std::string& path, std::string_view text, const std::string& kind) {
    YAML::Node root;
    try {
        for (const YAML::Node& document : YAML::LoadAll(without_header(text))) {
            if (root.IsMap() && !document.IsNull()) {
                refuse_calibration(path,
                                   "holds several documents, with --- between them; expected one: keep the one "
                                   "that is meant");
            }
            root = root.IsMap() ? root : document;
        }
    } catch (const YAML::Exception& error) {
        refuse_calibration(path, "line " + std::to_string(error.mark.line + 1) + ": is a damaged " + kind);
    }
    if (!root.IsMap()) {
        refuse_calibration(path, "is a damaged " + kind + ": it has no entries");
    }
    std::set<std::string> names;
    for (const auto& item : root) {
        const std::string name = word_of(item.first);
        if (!names.insert(name).second) {
            refuse_calibration(
                path, "has the key '" + base::printable(name) + "' twice; once is allowed: take the wrong one out");
        }
    }
    return root;
}

std::string word_of(const YAML::Node& node) {
    return node && node.IsScalar() ? node.Scalar() : std::string();
}

}  // namespace disparityd::calibration
