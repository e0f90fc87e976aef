// SPDX-License-Identifier: Apache-2.0
#include "formats/ros_message.h"

#include <cmath>
#include <stdexcept>
#include <type_traits>
#include <utility>

#include "base/message_text.h"
#include "formats/cdr_reader.h"
#include "formats/ros1_reader.h"

namespace disparityd::formats {
namespace {

constexpr std::size_t most_numbers = 4096;
constexpr std::size_t most_elements = 64;        // of an array of messages
constexpr std::size_t most_kept = 10'000;        // fields, before an element of such an array
constexpr std::size_t most_all = 2 * most_kept;  // fields, with those of elements
constexpr std::size_t most_empty = 100'000;

std::size_t size_of(RosKind kind) {
    switch (kind) {
        case RosKind::int16:
        case RosKind::uint16: return 2;
        case RosKind::int32:
        case RosKind::uint32:
        case RosKind::float32: return 4;
        case RosKind::int64:
        case RosKind::uint64:
        case RosKind::float64: return 8;
        default: return 1;
    }
}

template <class Reader>
double read_number(Reader& bytes, RosKind kind) {
    switch (kind) {
        case RosKind::int8: return bytes.template get<std::int8_t>();
        case RosKind::int16: return bytes.template get<std::int16_t>();
        case RosKind::uint16: return bytes.template get<std::uint16_t>();
        case RosKind::int32: return bytes.template get<std::int32_t>();
        case RosKind::uint32: return bytes.template get<std::uint32_t>();
        case RosKind::int64: return static_cast<double>(bytes.template get<std::int64_t>());
        case RosKind::uint64: return static_cast<double>(bytes.template get<std::uint64_t>());
        case RosKind::float32: return bytes.template get<float>();
        case RosKind::float64: return bytes.template get<double>();
        default: return bytes.template get<std::uint8_t>();
    }
}

/// Walks through the bytes as the schema says, and keeps what it meets. It ends with the message: each field takes a
/// byte at least, and messages without fields, which take none in ROS 1, are counted.
template <class Reader>
class MessageWalk {
public:
    using Fields = std::map<std::string, RosMessage::Value, std::less<>>;

    MessageWalk(const RosSchema& schema, Reader& bytes, Fields& fields)
        : schema_(schema), bytes_(bytes), fields_(fields) {}

    /// `prefix` is the path of the message with a point behind it; nullptr: nothing is kept.
    void walk(std::size_t definition, const std::string* prefix) {
        const std::vector<RosField>& fields = schema_.definitions[definition].fields;
        if (fields.empty()) {
            pass_empty();
        }
        for (const RosField& field : fields) {
            const std::string path = prefix == nullptr ? std::string() : *prefix + field.name;
            if (field.count == RosField::Count::one) {
                read_one(field, prefix == nullptr ? nullptr : &path);
            } else {
                const std::size_t count =
                    field.count == RosField::Count::fixed ? field.size : bytes_.template get<std::uint32_t>();
                read_many(field, count, prefix == nullptr ? nullptr : &path);
            }
        }
    }

private:
    void pass_empty() {
        if constexpr (std::is_same_v<Reader, CdrReader>) {
            bytes_.template get<std::uint8_t>();  // what has no field is sent as one byte
        } else if (++empty_ > most_empty) {
            throw std::runtime_error("has more than " + std::to_string(most_empty) + " messages without fields");
        }
    }

    void read_one(const RosField& field, const std::string* path) {
        if (field.kind == RosKind::message) {
            const std::string prefix = path == nullptr ? std::string() : *path + ".";
            walk(field.definition, path == nullptr ? nullptr : &prefix);
            return;
        }
        if (field.kind == RosKind::text || field.kind == RosKind::wide_text) {
            keep(path, read_text(field));
        } else {
            keep(path, read_number(bytes_, field.kind));
        }
    }

    void read_many(const RosField& field, std::size_t count, const std::string* path) {
        const bool words = field.kind == RosKind::text || field.kind == RosKind::wide_text;
        if (words || field.kind == RosKind::message) {
            for (std::size_t i = 0; i < count; ++i) {
                const bool kept = path != nullptr && !words && i < most_elements && fields_.size() < most_kept;
                const std::string element = kept ? *path + "." + std::to_string(i) : std::string();
                read_one(field, kept ? &element : nullptr);
            }
            return;
        }
        const std::size_t size = size_of(field.kind);
        if (size == 1) {
            keep(path, bytes_.elements(count, 1));
        } else if (path == nullptr || count > most_numbers) {
            bytes_.elements(count, size);
        } else {
            std::vector<double> numbers;
            for (std::size_t i = 0; i < count; ++i) {
                numbers.push_back(read_number(bytes_, field.kind));
            }
            keep(path, std::move(numbers));
        }
    }

    std::string_view read_text(const RosField& field) {
        if (field.kind == RosKind::wide_text) {
            throw std::runtime_error("has the field " + base::printable(field.name) +
                                     " of type wstring, which writers do not agree on: it is not read");
        }
        return bytes_.text();
    }

    void keep(const std::string* path, RosMessage::Value value) {
        if (path != nullptr) {
            if (fields_.size() >= most_all) {
                throw std::runtime_error("has more than " + std::to_string(most_all) + " fields");
            }
            fields_.emplace(*path, std::move(value));
        }
    }

    const RosSchema& schema_;
    Reader& bytes_;
    Fields& fields_;
    std::size_t empty_ = 0;
};

}  // namespace

RosMessage::RosMessage(const RosSchema& schema, std::span<const std::uint8_t> bytes, RosEncoding encoding) {
    const std::string prefix;
    if (encoding == RosEncoding::cdr) {
        CdrReader reader(bytes);
        MessageWalk(schema, reader, fields_).walk(0, &prefix);
    } else {
        Ros1Reader reader(bytes);
        MessageWalk(schema, reader, fields_).walk(0, &prefix);
    }
}

template <typename Kind>
const Kind& RosMessage::get(std::string_view path, const char* kind) const {
    const auto found = fields_.find(path);
    if (found == fields_.end() || !std::holds_alternative<Kind>(found->second)) {
        throw std::runtime_error("has no field " + std::string(path) + " that is " + kind);
    }
    return std::get<Kind>(found->second);
}

double RosMessage::number(std::string_view path) const {
    return get<double>(path, "a number");
}

std::int64_t RosMessage::integer(std::string_view path) const {
    constexpr double most = 4294967295.0;
    const double value = number(path);
    if (!(value >= -most && value <= most) || value != std::trunc(value)) {
        throw std::runtime_error("has a field " + std::string(path) + " that is no whole number of 32 bits");
    }
    return static_cast<std::int64_t>(value);
}

std::string_view RosMessage::text(std::string_view path) const {
    return get<std::string_view>(path, "a text");
}

std::span<const std::uint8_t> RosMessage::bytes(std::string_view path) const {
    return get<std::span<const std::uint8_t>>(path, "bytes");
}

const std::vector<double>& RosMessage::numbers(std::string_view path) const {
    return get<std::vector<double>>(path, "a list of numbers");
}

}  // namespace disparityd::formats
