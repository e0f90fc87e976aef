// SPDX-License-Identifier: Apache-2.0
#include "formats/ros_schema.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <optional>
#include <stdexcept>
#include <utility>

#include "base/message_text.h"
#include "base/words.h"

namespace disparityd::formats {
namespace {

constexpr std::size_t most_definitions = 1000;
constexpr std::size_t most_fields = 10000;  // of all definitions together
constexpr std::size_t longest_name = 255;
constexpr int deepest = 16;

constexpr std::array<std::pair<std::string_view, RosKind>, 15> kinds{{{"bool", RosKind::boolean},
                                                                      {"byte", RosKind::uint8},
                                                                      {"char", RosKind::uint8},
                                                                      {"int8", RosKind::int8},
                                                                      {"uint8", RosKind::uint8},
                                                                      {"int16", RosKind::int16},
                                                                      {"uint16", RosKind::uint16},
                                                                      {"int32", RosKind::int32},
                                                                      {"uint32", RosKind::uint32},
                                                                      {"int64", RosKind::int64},
                                                                      {"uint64", RosKind::uint64},
                                                                      {"float32", RosKind::float32},
                                                                      {"float64", RosKind::float64},
                                                                      {"string", RosKind::text},
                                                                      {"wstring", RosKind::wide_text}}};

/// What writers may leave out, as every system has it.
constexpr std::array<std::pair<std::string_view, std::string_view>, 2> known{
    {{"builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n"},
     {"builtin_interfaces/Duration", "int32 sec\nuint32 nanosec\n"}}};

/// Returns "package/Type" for "package/msg/Type", too.
std::string short_name(std::string_view name) {
    const auto first = name.find('/');
    const auto last = name.rfind('/');
    return first == last ? std::string(name) : std::string(name.substr(0, first)) + std::string(name.substr(last));
}

std::string_view package_of(std::string_view name) {
    return name.substr(0, name.find('/'));
}

/// The text of each definition by its name.
using Texts = std::map<std::string, std::string_view, std::less<>>;

bool is_separator(std::string_view line) {
    constexpr std::size_t least = 10;
    return line.size() >= least && line.find_first_not_of('=') == std::string_view::npos;
}

Texts split_definitions(std::string_view name, std::string_view text) {
    Texts texts;
    std::string current = short_name(name);
    const char* begin = text.data();
    const auto keep = [&](const char* end) {
        texts.emplace(current, std::string_view(begin, static_cast<std::size_t>(end - begin)));
        if (texts.size() > most_definitions) {
            throw std::runtime_error("its schema has more than " + std::to_string(most_definitions) + " types");
        }
    };
    bool expects_name = false;
    for (const std::string_view whole : base::split(text, '\n')) {
        const std::string_view line = base::trim(whole);
        constexpr std::string_view name_key = "MSG:";
        if (is_separator(line)) {
            keep(whole.data());
            expects_name = true;
        } else if (expects_name && line.starts_with(name_key)) {
            current = short_name(base::trim(line.substr(name_key.size())));
            begin = whole.data() + whole.size();
            expects_name = false;
        } else if (expects_name && !line.empty()) {
            throw std::runtime_error("its schema has the line '" + base::printable(line) +
                                     "', expected 'MSG: package/Type'");
        }
    }
    if (!expects_name) {
        keep(text.data() + text.size());
    }
    return texts;
}

/// Takes a word, up to a blank, from the front.
std::string_view take_word(std::string_view& line) {
    const std::string_view word = line.substr(0, line.find_first_of(" \t"));
    line = base::trim(line.substr(word.size()));
    return word;
}

/// Makes the definitions out of their texts.
class SchemaParser {
public:
    explicit SchemaParser(Texts texts) : texts_(std::move(texts)) {}

    /// Returns the place of a definition, which it adds where it is new.
    std::size_t add(const std::string& name, int depth) {
        if (depth > deepest) {
            throw std::runtime_error("its schema has types within each other more than " + std::to_string(deepest) +
                                     " deep, at " + base::printable(name));
        }
        if (const auto found = places_.find(name); found != places_.end()) {
            if (!found->second) {
                throw std::runtime_error("its schema has the type " + base::printable(name) + ", which has itself");
            }
            return *found->second;
        }
        const std::string_view text = text_of(name);
        const std::size_t place = schema_.definitions.size();
        schema_.definitions.push_back({name, {}});
        places_[name] = std::nullopt;
        std::vector<RosField> fields;
        for (const std::string_view whole : base::split(text, '\n')) {
            if (auto field = parse_field(name, whole, depth)) {
                fields.push_back(*std::move(field));
            }
        }
        schema_.definitions[place].fields = std::move(fields);
        places_[name] = place;
        return place;
    }

    RosSchema take() { return std::move(schema_); }

private:
    std::string_view text_of(const std::string& name) const {
        if (const auto found = texts_.find(name); found != texts_.end()) {
            return found->second;
        }
        const auto builtin =
            std::find_if(known.begin(), known.end(), [&](const auto& item) { return item.first == name; });
        if (builtin == known.end()) {
            throw std::runtime_error("its schema does not define the type " + base::printable(name));
        }
        return builtin->second;
    }

    [[noreturn]] static void refuse(const std::string& name, std::string_view line) {
        throw std::runtime_error("its schema has the line '" + base::printable(line) + "' in " + base::printable(name) +
                                 ", expected a type and a name");
    }

    /// Returns nothing for a line without a field: a constant, a comment.
    std::optional<RosField> parse_field(const std::string& definition, std::string_view whole, int depth) {
        std::string_view line = base::trim(whole.substr(0, whole.find('#')));
        if (line.empty()) {
            return std::nullopt;
        }
        std::string_view type = take_word(line);
        std::string_view name = line.substr(0, line.find_first_of(" \t="));
        // "uint8 GREY=1" and "uint8 GREY = 1", while a default value stands behind a blank.
        if (name.empty()) {
            refuse(definition, whole);
        }
        if (const std::string_view behind = base::trim(line.substr(name.size())); behind.starts_with('=')) {
            return std::nullopt;
        }
        if (name.size() > longest_name) {
            throw std::runtime_error("its schema has a field whose name has " + std::to_string(name.size()) +
                                     " bytes, allowed are up to " + std::to_string(longest_name));
        }
        if (++fields_ > most_fields) {
            throw std::runtime_error("its schema has more than " + std::to_string(most_fields) + " fields");
        }
        RosField field;
        field.name = name;
        if (const auto bracket = type.find('['); bracket != std::string_view::npos) {
            take_count(definition, whole, type.substr(bracket), field);
            type = type.substr(0, bracket);
        }
        type = type.substr(0, type.find("<="));  // the most that a text may have
        const auto kind =
            std::find_if(kinds.begin(), kinds.end(), [&](const auto& item) { return item.first == type; });
        if (kind != kinds.end()) {
            field.kind = kind->second;
            return field;
        }
        field.kind = RosKind::message;
        field.definition = add(resolved(definition, type), depth + 1);
        return field;
    }

    /// Reads "[]", "[<=5]" or "[5]".
    static void take_count(const std::string& definition, std::string_view line, std::string_view brackets,
                           RosField& field) {
        if (brackets.size() < 2 || brackets.back() != ']') {
            refuse(definition, line);
        }
        const std::string_view count = brackets.substr(1, brackets.size() - 2);
        if (count.empty() || count.starts_with("<=")) {
            field.count = RosField::Count::sequence;
            return;
        }
        field.count = RosField::Count::fixed;
        const auto [end, error] = std::from_chars(count.data(), count.data() + count.size(), field.size);
        if (error != std::errc() || end != count.data() + count.size() || field.size == 0) {
            refuse(definition, line);
        }
    }

    /// Returns the name of a type as the text of `definition` means it: of the same package where it names none.
    std::string resolved(const std::string& definition, std::string_view type) const {
        if (type.find('/') != std::string_view::npos) {
            return short_name(type);
        }
        if (type == "Header") {
            return "std_msgs/Header";
        }
        if (type == "time" || type == "duration") {
            return type == "time" ? "builtin_interfaces/Time" : "builtin_interfaces/Duration";
        }
        return std::string(package_of(definition)) + "/" + std::string(type);
    }

    Texts texts_;
    std::map<std::string, std::optional<std::size_t>> places_;  ///< without a place: it is being read
    std::size_t fields_ = 0;
    RosSchema schema_;
};

}  // namespace

RosSchema parse_ros_schema(std::string_view name, std::string_view text) {
    SchemaParser parser(split_definitions(name, text));
    parser.add(short_name(name), 1);
    return parser.take();
}

}  // namespace disparityd::formats
