// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace disparityd::calibration {

/// Reads the top level of a file that OpenCV's FileStorage has written, YAML (with its first line or without), JSON or
/// XML. Does not use OpenCV's parser: that allocates what a damaged file claims, and crashes on some files.
class OpencvStorage {
public:
    struct Matrix {
        int rows = 0;
        int columns = 0;
        std::vector<double> numbers;  ///< row by row
    };

    /// Throws std::invalid_argument with one line when the text is none of these, or has a key twice; `path` is for
    /// messages.
    OpencvStorage(std::string path, std::string_view text);

    /// Takes over the entries of another file. Returns the names of those that both have and that differ; of these the
    /// ones of this file stay. Messages name both files from then on.
    std::vector<std::string> add(const OpencvStorage& other);

    /// Returns the names of all entries.
    std::vector<std::string> names() const;

    bool has(const std::string& name) const { return entries_.contains(name); }

    /// Returns the matrix of this name, or nothing. Throws std::invalid_argument when the entry is no matrix of finite
    /// numbers with one channel, at most 64 x 64.
    std::optional<Matrix> matrix(const std::string& name) const;

    /// Returns the word of this name, such as a text or a number; empty when there is none.
    std::string word(const std::string& name) const;

    /// Returns the numbers of a scalar, a sequence or a matrix; nothing when it is none or holds anything else.
    std::optional<std::vector<double>> numbers(const std::string& name) const;

    /// Returns the entry as a message shows it: the word, or "a matrix", "a list", "a block of other keys".
    std::string shown(const std::string& name) const;

    /// Throws std::invalid_argument with a line that names the file.
    [[noreturn]] void fail(const std::string& what) const;

private:
    /// An entry as text: the word of a scalar, the words of a sequence, or the parts of a matrix.
    struct Entry {
        std::string word;
        std::string rows, columns, type;
        std::optional<std::vector<std::string>> data;
        bool is_map = false;
        bool operator==(const Entry&) const = default;
    };

    void read_yaml(std::string_view text);
    void read_xml(std::string_view text);

    std::string path_;
    std::map<std::string, Entry, std::less<>> entries_;
};

}  // namespace disparityd::calibration
