// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tools/eval/benchmark/benchmark_rows.h"
#include "tools/eval/scene.h"
#include "tools/images/disparity_map.h"

namespace disparityd::eval {

/// A page that shows, for each matcher and scene, the left image, the disparity and where it is wrong, the worst first
/// by bad-1.0 of all pixels; a reader may sort by any other figure and region. It needs nothing but its folder: it
/// opens from a file, and its pictures lie beside it.
class ErrorPage {
public:
    /// `folder` exists.
    explicit ErrorPage(std::string folder) : folder_(std::move(folder)) {}

    /// Writes the pictures of one result; `cells` are its figures in each region. Throws std::runtime_error when the
    /// system refuses.
    void add(const Scene& scene, const images::FloatMap& disparity, const std::vector<BenchmarkCell>& cells);

    /// Writes index.html, and nothing where nothing was added. Throws as add().
    void write(Holes holes) const;

private:
    /// One result and the names of its pictures.
    struct Entry {
        std::string scene;
        std::string matcher;
        std::string left, disparity, errors;
        std::vector<BenchmarkCell> cells;
    };

    std::string entry_html(const Entry& entry, std::size_t number) const;

    std::string folder_;
    std::vector<Entry> entries_;
};

}  // namespace disparityd::eval
