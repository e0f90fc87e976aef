// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include <nlohmann/json_fwd.hpp>

namespace disparityd::eval {

/// Four decimals are more than the pixels tell; the rest is noise of the number format.
inline nlohmann::ordered_json rounded_number(double value) {
    return std::isnan(value) ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(std::round(value * 1e4) / 1e4);
}

/// The middle one of at least one value, in any order; the mean of the two in the middle for an even count.
inline double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const std::size_t middle = values.size() / 2;
    return values.size() % 2 == 1 ? values[middle] : (values[middle - 1] + values[middle]) / 2;
}

/// A figure that a report has for each scene and matcher.
struct Figure {
    std::string heading;  ///< of its column
    std::string key;      ///< in JSON
    int decimals = 2;
};

/// What a matcher reached on one scene: a value for each figure, NaN where it is not known.
struct Measured {
    std::string scene;
    std::string method;
    std::string backend;
    std::vector<double> values;
};

/// The means of a matcher over scenes: for each figure of those scenes where it is known, NaN where there is none.
struct Mean {
    std::string method;
    std::string backend;
    std::size_t scenes = 0;
    std::vector<double> values;
};

/// All that one report prints, before it is text.
struct Measurements {
    std::vector<Figure> figures;
    std::vector<Measured> rows;
};

/// Whether a scene counts.
using SceneFilter = std::function<bool(const std::string& scene)>;

/// Returns the means of each matcher, in the order in which the matchers appear first, over the scenes that count.
std::vector<Mean> means(const Measurements& measured, const SceneFilter& counts);

/// The same over all scenes.
std::vector<Mean> means(const Measurements& measured);

/// Returns "-" where the value is not known.
std::string figure_text(double value, int decimals);

/// Appends each value as text to a line of a table.
void append_figures(const std::vector<double>& values, const std::vector<Figure>& figures,
                    std::vector<std::string>& line);

/// Adds each value under its figure's key, null where it is not known.
void add_figures(const std::vector<double>& values, const std::vector<Figure>& figures, nlohmann::ordered_json& object);

/// Returns a list of objects: method, backend, scenes (their number), and the key of each figure.
nlohmann::ordered_json means_json(const std::vector<Mean>& means, const std::vector<Figure>& figures);

}  // namespace disparityd::eval
