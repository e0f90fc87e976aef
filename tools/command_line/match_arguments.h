// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "kernels/options.h"

namespace CLI {
class App;
}  // namespace CLI

namespace disparityd::tools {

/// Every option of matching but the method, as the command line has them; what is not given keeps the tuned default
/// of the method.
class MatchArguments {
public:
    /// `disparities_default` completes the sentence in --help; `usual` is the preset where none is given.
    void add_to(CLI::App& app, const std::string& disparities_default, Preset usual = Preset::paper);

    const std::optional<int>& disparities() const { return disparities_; }
    int d_min() const { return d_min_.value_or(0); }
    const std::optional<bool>& subpixel() const { return subpixel_; }
    const std::optional<bool>& interpolate() const { return interpolate_; }
    const std::optional<int>& min_texture() const { return min_texture_; }

    /// Options for a method; `disparities` candidates where --disparities is not given. Throws std::invalid_argument
    /// with one line when they do not fit together.
    /// Makes `usual` the preset that options() begin with where the command line has none.
    void set_usual(Preset usual) { usual_ = usual; }

    MatchOptions options(Method method, int disparities) const;

    /// Throws std::invalid_argument with one line when an option is given that none of the methods uses.
    void check_used(const std::vector<Method>& methods) const;

private:
    std::optional<int> d_min_, disparities_, paths_, p1_, p2_, p2_slope_, p2_min_, uniqueness_, median_, guided_median_,
        speckle_size_, speckle_step_, min_texture_;
    Preset usual_ = Preset::paper;
    std::string preset_, cost_;
    std::optional<bool> adaptive_p2_, calibrated_confidence_, subpixel_, local_extrema_, left_right_check_,
        interpolate_;
};

/// Throws std::invalid_argument for a word that is no method.
Method parse_method(const std::string& text);

/// For --method: when which method serves (docs/operations.md has the figures).
std::string method_help();

/// For --backend: the names that there are, with their descriptions.
std::string backend_help();

}  // namespace disparityd::tools
