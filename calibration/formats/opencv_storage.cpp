// SPDX-License-Identifier: Apache-2.0
#include "calibration/formats/opencv_storage.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <yaml-cpp/yaml.h>

#include "base/message_text.h"
#include "base/number_text.h"
#include "base/words.h"

namespace disparityd::calibration {

namespace {

constexpr int largest = 64;  // rows or columns; a calibration's have five at most

std::string scalar(const YAML::Node& node) {
    return node && node.IsScalar() ? node.Scalar() : std::string();
}

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
    if (text.starts_with("<?xml")) {
        read_xml(text);
    } else if (text.starts_with("%YAML")) {
        read_yaml(text);
    } else {
        fail("is no OpenCV YAML or XML file");
    }
}

void OpencvStorage::fail(const std::string& what) const {
    throw std::invalid_argument("calibration " + path_ + ": " + what);
}

void OpencvStorage::read_yaml(std::string_view text) {
    // The first line, "%YAML:1.0", is not valid YAML: the standard has a blank there.
    text.remove_prefix(std::min(text.find('\n'), text.size()));
    YAML::Node root;
    try {
        root = YAML::Load(std::string(text));
    } catch (const YAML::Exception& error) {
        fail("is a damaged OpenCV YAML file: line " + std::to_string(error.mark.line + 1));
    }
    if (!root.IsMap()) {
        fail("is a damaged OpenCV YAML file: it has no entries");
    }
    for (const auto& item : root) {
        const YAML::Node& value = item.second;
        Entry entry;
        if (value.IsMap()) {
            entry.rows = scalar(value["rows"]);
            entry.columns = scalar(value["cols"]);
            entry.type = scalar(value["dt"]);
            if (const YAML::Node data = value["data"]; data && data.IsSequence()) {
                entry.data.emplace();
                for (const YAML::Node& number : data) {
                    entry.data->push_back(scalar(number));
                }
            }
        } else {
            entry.word = scalar(value);
        }
        entries_.emplace(scalar(item.first), std::move(entry));
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
        Entry entry{std::string(base::trim(element->content)), {}, {}, {}, {}};
        XmlReader parts(element->content);
        while (const auto part = parts.next()) {
            const std::string content(base::trim(part->content));
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
        entries_.emplace(element->name, std::move(entry));
    }
    if (list.broken()) {
        fail("is a damaged OpenCV XML file: a tag is not closed");
    }
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
    if (count == 0 || !one_channel || !entry.data || entry.data->size() != count) {
        fail(name + " is no matrix");
    }
    for (const std::string& word : *entry.data) {
        const auto number = base::parse_number(word);
        if (!number) {
            fail(name + " has values that are no numbers: found '" + base::printable(word) + "'");
        }
        matrix.numbers.push_back(*number);
    }
    return matrix;
}

std::optional<int> OpencvStorage::integer(const std::string& name) const {
    const auto found = entries_.find(name);
    const auto number = base::parse_number(found == entries_.end() ? std::string_view() : found->second.word);
    constexpr double most = 1e9;
    if (!number || *number < -most || *number > most || *number != static_cast<int>(*number)) {
        return std::nullopt;
    }
    return static_cast<int>(*number);
}

}  // namespace disparityd::calibration
