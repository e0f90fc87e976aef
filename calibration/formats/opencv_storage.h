// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace disparityd::calibration {

/// Reads the top level of a file that OpenCV's FileStorage has written, YAML or XML. Does not use OpenCV's parser: that
/// allocates what a damaged file claims, and crashes on some files.
class OpencvStorage {
public:
    struct Matrix {
        int rows = 0;
        int columns = 0;
        std::vector<double> numbers;  ///< row by row
    };

    /// Throws std::invalid_argument with one line when the text is neither YAML nor XML; `path` is for messages.
    OpencvStorage(std::string path, std::string_view text);

    /// Returns the matrix of this name, or nothing. Throws std::invalid_argument when the entry is no matrix of finite
    /// numbers with one channel, at most 64 x 64.
    std::optional<Matrix> matrix(const std::string& name) const;

    /// Returns the integer of this name; nothing when there is none or it is no whole number.
    std::optional<int> integer(const std::string& name) const;

    /// Throws std::invalid_argument with a line that names the file.
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

}  // namespace disparityd::calibration
