// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>

namespace disparityd::web {

/// A label of a sample. The value may be any bytes.
struct Label {
    std::string_view name;
    std::string_view value;
};

/// Writes Prometheus' text format 0.0.4: metric by metric, each with its help and type before its samples. Names and
/// helps are the program's own and must be as the format wants them; values of labels come from anywhere and are
/// escaped.
class Exposition {
public:
    using Labels = std::initializer_list<Label>;

    /// Begins a metric of several samples.
    void begin(std::string_view name, std::string_view type, std::string_view help);
    void sample(Labels labels, double value);
    void sample(Labels labels, std::uint64_t value);

    /// Writes a metric of one sample without labels.
    void gauge(std::string_view name, std::string_view help, double value);
    void counter(std::string_view name, std::string_view help, std::uint64_t value);

    /// Writes a gauge that is 1, for what its labels say.
    void info(std::string_view name, std::string_view help, Labels labels);

    /// Writes a gauge for each of `states`, and for "other": 1 for the one that is `now`, else 0. A state that is not
    /// among them is the "other" one: a newer daemon may have it.
    void states(std::string_view name, std::string_view help, std::span<const std::string_view> states,
                std::string_view now);

    /// Writes one histogram of the metric that was begun: `up_to` counts what is at most as large as each of `bounds`,
    /// `count` all.
    void histogram(Labels labels, std::span<const double> bounds, std::span<const std::uint64_t> up_to,
                   std::uint64_t count, double sum);

    std::string take() { return std::move(text_); }

private:
    void put_name(std::string_view suffix, Labels labels, const Label* last);
    void line(std::string_view suffix, Labels labels, const Label* last, std::string_view value);

    std::string text_;
    std::string name_;
};

}  // namespace disparityd::web
