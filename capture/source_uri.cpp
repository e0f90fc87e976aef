// SPDX-License-Identifier: Apache-2.0
#include "capture/source_uri.h"

#include <algorithm>
#include <stdexcept>

#include "base/message_text.h"
#include "base/number_text.h"
#include "base/words.h"

namespace disparityd::capture {

SourceUri::SourceUri(const std::string& uri) : uri_(uri), name_(std::string_view(uri).substr(uri.find(':') + 1)) {
    if (const auto question = name_.find('?'); question != std::string_view::npos) {
        parameters_ = name_.substr(question + 1);
        name_ = name_.substr(0, question);
    }
    if (const auto at = name_.find('@'); at != std::string_view::npos) {
        rate_ = name_.substr(at + 1);
        name_ = name_.substr(0, at);
    }
}

std::vector<SourceUri::Parameter> SourceUri::parameters() const {
    std::vector<Parameter> list;
    if (parameters_.empty()) {
        return list;
    }
    for (const std::string_view text : base::split(parameters_, '&')) {
        const auto equals = text.find('=');
        const std::string_view key = text.substr(0, equals);
        if (std::any_of(list.begin(), list.end(), [key](const Parameter& other) { return other.key == key; })) {
            fail("parameter", std::string(key) + " twice", "each parameter once");
        }
        list.push_back({text, key, equals == std::string_view::npos ? std::string_view() : text.substr(equals + 1)});
    }
    return list;
}

void SourceUri::fail(const std::string& what, std::string_view found, const std::string& allowed) const {
    constexpr std::size_t longest_uri = 300;
    throw std::invalid_argument("source " + base::printable(uri_, longest_uri) + ": " + what + ": found '" +
                                base::printable(found) + "', allowed is " + allowed);
}

double SourceUri::number(const std::string& what, std::string_view text, double least, double most) const {
    const auto number = base::parse_number(text);
    if (!number || *number < least || *number > most) {
        fail(what, text, base::number_text(least) + " to " + base::number_text(most));
    }
    return *number;
}

int SourceUri::integer(const std::string& what, std::string_view text, int least, int most) const {
    const double value = number(what, text, least, most);
    if (value != static_cast<int>(value)) {
        fail(what, text, "a whole number");
    }
    return static_cast<int>(value);
}

}  // namespace disparityd::capture
