// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/metrics/exposition.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "proto/text.h"

namespace disparityd::web {
namespace {

std::string number(double value) {
    if (std::isnan(value)) {
        return "NaN";
    }
    if (std::isinf(value)) {
        return value > 0 ? "+Inf" : "-Inf";
    }
    return fmt::format("{}", value);
}

/// Returns a label's value as it stands between quotes: valid UTF-8 on one line.
std::string escaped(std::string_view value) {
    std::string out;
    for (const char byte : proto::to_valid_utf8(value)) {
        switch (byte) {
            case '\\': out += "\\\\"; break;
            case '"': out += "\\\""; break;
            case '\n': out += "\\n"; break;
            // Other control characters mean nothing in a name, and parsers differ about them.
            default: out += static_cast<unsigned char>(byte) < 0x20 || byte == 0x7f ? '?' : byte;
        }
    }
    return out;
}

}  // namespace

void Exposition::begin(std::string_view name, std::string_view type, std::string_view help) {
    name_ = name;
    text_ += fmt::format("# HELP {} {}\n# TYPE {} {}\n", name, help, name, type);
}

void Exposition::sample(Labels labels, double value) {
    line("", labels, nullptr, number(value));
}

void Exposition::sample(Labels labels, std::uint64_t value) {
    line("", labels, nullptr, fmt::format("{}", value));
}

void Exposition::gauge(std::string_view name, std::string_view help, double value) {
    begin(name, "gauge", help);
    sample({}, value);
}

void Exposition::counter(std::string_view name, std::string_view help, std::uint64_t value) {
    begin(name, "counter", help);
    sample({}, value);
}

void Exposition::info(std::string_view name, std::string_view help, Labels labels) {
    begin(name, "gauge", help);
    sample(labels, std::uint64_t{1});
}

void Exposition::states(std::string_view name, std::string_view help, std::span<const std::string_view> states,
                        std::string_view now) {
    begin(name, "gauge", help);
    const auto put = [this](std::string_view state, bool is) { sample({{"state", state}}, std::uint64_t{is}); };
    for (const std::string_view state : states) {
        put(state, state == now);
    }
    put("other", std::find(states.begin(), states.end(), now) == states.end());
}

void Exposition::histogram(Labels labels, std::span<const double> bounds, std::span<const std::uint64_t> up_to,
                           std::uint64_t count, double sum) {
    for (std::size_t i = 0; i < std::min(bounds.size(), up_to.size()); ++i) {
        const std::string bound = number(bounds[i]);
        const Label last{"le", bound};
        line("_bucket", labels, &last, fmt::format("{}", up_to[i]));
    }
    const Label all{"le", "+Inf"};
    line("_bucket", labels, &all, fmt::format("{}", count));
    line("_sum", labels, nullptr, number(sum));
    line("_count", labels, nullptr, fmt::format("{}", count));
}

void Exposition::put_name(std::string_view suffix, Labels labels, const Label* last) {
    text_ += name_;
    text_ += suffix;
    char before = '{';
    const auto put = [&](const Label& label) {
        text_ += fmt::format("{}{}=\"{}\"", before, label.name, escaped(label.value));
        before = ',';
    };
    for (const Label& label : labels) {
        put(label);
    }
    if (last != nullptr) {
        put(*last);
    }
    text_ += before == ',' ? "}" : "";
}

void Exposition::line(std::string_view suffix, Labels labels, const Label* last, std::string_view value) {
    put_name(suffix, labels, last);
    text_ += ' ';
    text_ += value;
    text_ += '\n';
}

}  // namespace disparityd::web
