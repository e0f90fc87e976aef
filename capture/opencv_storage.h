// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace disparityd::capture {

/// The top level of a file that OpenCV's FileStorage has written, YAML or XML. Read without OpenCV: its own parser
/// takes memory for what a damaged file claims, and crashes on some.
class OpencvStorage {
public:
    struct Matrix {
        int rows = 0;
        int columns = 0;
        std::vector<double> numbers;  ///< row by row
    };

    /// Throws std::invalid_argument with one line when the text is neither; `path` is for messages.
    OpencvStorage(std::string path, std::string_view text);

    /// Nothing when there is none of this name. Throws std::invalid_argument when what has the name is no matrix of
    /// finite numbers with one channel, at most 64 x 64.
    std::optional<Matrix> matrix(const std::string& name) const;

    /// Nothing when there is none of this name, or it is no whole number.
    std::optional<int> integer(const std::string& name) const;

    [[noreturn]] void fail(const std::string& what) const;

private:
    /// An entry as text: the word of a scalar, or the parts of a matrix.
    struct Entry {
        std::string word;
        std::string rows, columns, type;
        std::optional<std::vector<std::string>> data;
    };

    void read_yaml(std::string_view text);
    void read_xml(std::string_view text);

    std::string path_;
    std::map<std::string, Entry, std::less<>> entries_;
};

}  // namespace disparityd::capture
