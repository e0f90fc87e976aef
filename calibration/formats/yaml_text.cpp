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

/// Returns whether something follows a line that ends a document which has something. Such lines begin with "---" in
/// all of YAML. The library's own reader of all documents does not end for each damaged text.
bool has_several_documents(std::string_view text) {
    bool has_content = false;
    bool ended = false;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        std::string_view line = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
        const bool marker = line.starts_with("---") && (line.size() == 3 || base::trim(line.substr(3, 1)).empty());
        if (marker) {
            ended = has_content;
            line.remove_prefix(3);
        }
        const std::string_view content = base::trim(line);
        if (content.empty() || content == "..." || content[0] == '#' || content[0] == '%') {
            continue;
        }
        if (ended) {
            return true;
        }
        has_content = true;
    }
    return false;
}

}  // namespace

YAML::Node read_yaml_map(const std::string& path, std::string_view text, const std::string& kind) {
    YAML::Node root;
    try {
        const std::string whole = without_header(text);
        if (has_several_documents(whole)) {
            refuse_calibration(
                path, "holds several documents, with --- between them; expected one: keep the one that is meant");
        }
        root = YAML::Load(whole);
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
