// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/csv.h"

#include "base/message_text.h"

namespace disparityd::tools {

std::string csv_field(std::string_view text) {
    const std::string line = base::printable(text, text.size());
    if (line.find_first_of(",\"") == std::string::npos) {
        return line;
    }
    std::string field = "\"";
    for (const char c : line) {
        field += c;
        if (c == '"') {
            field += c;
        }
    }
    return field + '"';
}

std::vector<std::string> csv_fields(std::string_view line) {
    std::vector<std::string> fields(1);
    bool quoted = false;
    for (std::size_t i = 0; i < line.size(); ++i) {
        const char c = line[i];
        if (quoted && c == '"' && i + 1 < line.size() && line[i + 1] == '"') {
            fields.back() += c;
            ++i;
        } else if (c == '"') {
            quoted = !quoted;
        } else if (c == ',' && !quoted) {
            fields.emplace_back();
        } else {
            fields.back() += c;
        }
    }
    return fields;
}

}  // namespace disparityd::tools
