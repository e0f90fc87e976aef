// SPDX-License-Identifier: Apache-2.0
#include "calibration/formats/opencv_storage.h"

#include <algorithm>
#include <utility>

#include "base/message_text.h"
#include "base/number_text.h"
#include "base/words.h"
#include "calibration/formats/calibration_formats.h"
#include "calibration/formats/yaml_text.h"

namespace disparityd::calibration {

namespace {

constexpr int largest = 64;  // rows or columns; a calibration's have five at most

std::vector<std::string> words(std::string_view text) {
    constexpr std::string_view blank = " \t\r\n";
    std::vector<std::string> list;
    for (;;) {
        const auto first = text.find_first_not_of(blank);
        if (first == std::string_view::npos) {
            return list;
        }
        text.remove_prefix(first);
        const auto end = std::min(text.find_first_of(blank), text.size());
        list.emplace_back(text.substr(0, end));
        text.remove_prefix(end);
    }
}

/// Appends the words of a list, and of the lists in it, as far as a matrix has places: lists that name each other may
/// stand for more than any memory holds.
void add_words(const YAML::Node& list, std::vector<std::string>& words, bool of_rows = true) {
    constexpr std::size_t enough = 64 * 64;
    for (const YAML::Node& item : list) {
        if (words.size() > enough) {
            return;
        }
        if (of_rows && item.IsSequence()) {
            add_words(item, words, false);
        } else {
            words.push_back(word_of(item));
        }
    }
}

/// Walks through the elements of the subset of XML that OpenCV writes: no entities, no declarations but the first line.
class XmlReader {
public:
    explicit XmlReader(std::string_view text) : rest_(text) {}

    struct Element {
        std::string name;
        std::string_view content;  ///< all between its tags
    };

    /// Returns the next element on this level; nothing at the end, or where the text is no XML: see broken().
    std::optional<Element> next() {
        if (!skip_to_tag()) {
            return std::nullopt;
        }
        const auto end = rest_.find('>');
        const std::string_view tag = rest_.substr(1, std::min(end, rest_.size()) - 1);
        const std::string name(tag.substr(0, tag.find_first_of(" \t\r\n/")));
        if (end == std::string_view::npos || name.empty()) {
            broken_ = true;
            return std::nullopt;
        }
        rest_.remove_prefix(end + 1);
        if (tag.ends_with('/')) {
            return Element{name, {}};
        }
        const std::string closing = "</" + name + ">";
        const auto close = rest_.find(closing);
        if (close == std::string_view::npos) {
            broken_ = true;
            return std::nullopt;
        }
        const Element element{name, rest_.substr(0, close)};
        rest_.remove_prefix(close + closing.size());
        return element;
    }

    bool broken() const { return broken_; }

private:
    bool skip_to_tag() {
        for (;;) {
            const auto at = rest_.find('<');
            if (at == std::string_view::npos) {
                return false;
            }
            rest_.remove_prefix(at);
            const bool comment = rest_.starts_with("<!--");
            if (!comment && !rest_.starts_with("<?")) {
                return true;
            }
            const std::string_view ending = comment ? "-->" : "?>";
            const auto end = rest_.find(ending);
            if (end == std::string_view::npos) {
                broken_ = true;
                return false;
            }
            rest_.remove_prefix(end + ending.size());
        }
    }

    std::string_view rest_;
    bool broken_ = false;
};

}  // namespace

OpencvStorage::OpencvStorage(std::string path, std::string_view text) : path_(std::move(path)) {
    if (text.starts_with("<")) {
        read_xml(text);
    } else {
        read_yaml(text);
    }
}

void OpencvStorage::fail(const std::string& what) const {
    refuse_calibration(path_, what);
}

void OpencvStorage::read_yaml(std::string_view text) {
    for (const auto& item : read_yaml_map(path_, text, "OpenCV YAML file")) {
        const YAML::Node& value = item.second;
        Entry entry;
        entry.is_map = value.IsMap();
        if (entry.is_map) {
            entry.rows = word_of(value["rows"]);
            entry.columns = word_of(value["cols"]);
            entry.type = word_of(value["dt"]);
            if (const YAML::Node data = value["data"]; data && data.IsSequence()) {
                add_words(data, entry.data.emplace());
            }
        } else if (value.IsSequence()) {
            // Rows in brackets, as Python's tolist() gives them; numbers alone are one row.
            const bool in_rows = value.size() > 0 && value[0].IsSequence();
            entry.rows = std::to_string(in_rows ? value.size() : 1);
            entry.columns = std::to_string(in_rows ? value[0].size() : value.size());
            entry.type = "d";
            add_words(value, entry.data.emplace());
        } else {
            entry.word = word_of(value);
        }
        entries_.emplace(word_of(item.first), std::move(entry));
    }
}

void OpencvStorage::read_xml(std::string_view text) {
    XmlReader file(text);
    const auto root = file.next();
    if (!root || root->name != "opencv_storage") {
        fail("is a damaged OpenCV XML file: it has no whole <opencv_storage>");
    }
    XmlReader list(root->content);
    while (const auto element = list.next()) {
        Entry entry{std::string(base::trim(element->content)), {}, {}, {}, {}, false};
        XmlReader parts(element->content);
        while (const auto part = parts.next()) {
            const std::string content(base::trim(part->content));
            entry.is_map = true;
            if (part->name == "rows") {
                entry.rows = content;
            } else if (part->name == "cols") {
                entry.columns = content;
            } else if (part->name == "dt") {
                entry.type = content;
            } else if (part->name == "data") {
                entry.data = words(content);
            }
        }
        if (!entries_.emplace(element->name, std::move(entry)).second) {
            fail("has the key '" + base::printable(element->name) + "' twice; once is allowed");
        }
    }
    if (list.broken()) {
        fail("is a damaged OpenCV XML file: a tag is not closed");
    }
}

std::vector<std::string> OpencvStorage::add(const OpencvStorage& other) {
    std::vector<std::string> different;
    for (const auto& [name, entry] : other.entries_) {
        const auto [there, is_new] = entries_.emplace(name, entry);
        if (!is_new && there->second != entry && (!numbers(name) || numbers(name) != other.numbers(name))) {
            different.push_back(name);
        }
    }
    path_ += "," + other.path_;
    return different;
}

std::vector<std::string> OpencvStorage::names() const {
    std::vector<std::string> names;
    for (const auto& [name, entry] : entries_) {
        names.push_back(name);
    }
    return names;
}

std::optional<OpencvStorage::Matrix> OpencvStorage::matrix(const std::string& name) const {
    const auto found = entries_.find(name);
    if (found == entries_.end()) {
        return std::nullopt;
    }
    const Entry& entry = found->second;
    const auto side = [&](const std::string& text) {
        const auto number = base::parse_number(text);
        return number && *number >= 1 && *number <= largest ? static_cast<int>(*number) : 0;
    };
    Matrix matrix{side(entry.rows), side(entry.columns), {}};
    const std::size_t count = static_cast<std::size_t>(matrix.rows) * static_cast<std::size_t>(matrix.columns);
    // One channel is a letter without a number in front: integers or floating point.
    const bool one_channel =
        entry.type.size() == 1 && std::string_view("ucwsifd").find(entry.type[0]) != std::string_view::npos;
    const std::string shown_name = base::printable(name);
    if (count == 0 || !one_channel || !entry.data) {
        fail(shown_name + " is no matrix of numbers (found " + shown(name) +
             "): rows, cols, dt and data are needed, or a list of rows, with 1 to 64 rows and columns");
    }
    if (entry.data->size() != count) {
        fail(shown_name + " has " + std::to_string(matrix.rows) + " rows and " + std::to_string(matrix.columns) +
             " columns, and " + base::counted(entry.data->size(), "number") + ": found a matrix that is not whole, " +
             std::to_string(count) + " are expected");
    }
    for (const std::string& word : *entry.data) {
        const auto number = base::parse_number(word);
        if (!number) {
            fail(shown_name + " has values that are no numbers: found '" + base::printable(word) + "'");
        }
        matrix.numbers.push_back(*number);
    }
    return matrix;
}

std::string OpencvStorage::word(const std::string& name) const {
    const auto found = entries_.find(name);
    return found == entries_.end() || found->second.is_map ? std::string() : found->second.word;
}

std::optional<std::vector<double>> OpencvStorage::numbers(const std::string& name) const {
    const auto found = entries_.find(name);
    if (found == entries_.end()) {
        return std::nullopt;
    }
    const Entry& entry = found->second;
    std::vector<double> numbers;
    for (const std::string& word : entry.data ? *entry.data : words(entry.word)) {
        const auto number = base::parse_number(word);
        if (!number) {
            return std::nullopt;
        }
        numbers.push_back(*number);
    }
    return numbers;
}

std::string OpencvStorage::shown(const std::string& name) const {
    const auto found = entries_.find(name);
    if (found == entries_.end()) {
        return "nothing";
    }
    const Entry& entry = found->second;
    return entry.is_map ? (entry.data ? "a matrix" : "a block of other keys")
           : entry.data ? "a list"
                        : "'" + base::printable(word(name)) + "'";
}

}  // namespace disparityd::calibration
