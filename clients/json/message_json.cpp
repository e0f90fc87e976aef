// SPDX-License-Identifier: Apache-2.0
#include "clients/json/message_json.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include <fmt/format.h>

#include "proto/disparity.pb.h"

namespace disparityd::json {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::Reflection;

std::string lower_case(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}

std::string word_of(const FieldDescriptor& field, int number) {
    const auto* const value = field.enum_type()->FindValueByNumber(number);
    return lower_case(value != nullptr ? value->name() : fmt::format("{} {}", field.enum_type()->name(), number));
}

/// Reads a field with the functions of Reflection for a single value, or with those for one element of a list.
template <typename Read>
Json value_of(const FieldDescriptor& field, const Read& read) {
    switch (field.cpp_type()) {
        case FieldDescriptor::CPPTYPE_INT32: return read(&Reflection::GetInt32, &Reflection::GetRepeatedInt32);
        case FieldDescriptor::CPPTYPE_INT64: return read(&Reflection::GetInt64, &Reflection::GetRepeatedInt64);
        case FieldDescriptor::CPPTYPE_UINT32: return read(&Reflection::GetUInt32, &Reflection::GetRepeatedUInt32);
        case FieldDescriptor::CPPTYPE_UINT64: {
            const std::uint64_t value = read(&Reflection::GetUInt64, &Reflection::GetRepeatedUInt64);
            return field.type() == FieldDescriptor::TYPE_FIXED64 ? Json(hexadecimal(value)) : Json(value);
        }
        case FieldDescriptor::CPPTYPE_DOUBLE: return read(&Reflection::GetDouble, &Reflection::GetRepeatedDouble);
        case FieldDescriptor::CPPTYPE_FLOAT: return read(&Reflection::GetFloat, &Reflection::GetRepeatedFloat);
        case FieldDescriptor::CPPTYPE_BOOL: return read(&Reflection::GetBool, &Reflection::GetRepeatedBool);
        case FieldDescriptor::CPPTYPE_ENUM:
            return word_of(field, read(&Reflection::GetEnumValue, &Reflection::GetRepeatedEnumValue));
        case FieldDescriptor::CPPTYPE_STRING: return read(&Reflection::GetString, &Reflection::GetRepeatedString);
        case FieldDescriptor::CPPTYPE_MESSAGE: break;
    }
    return nullptr;
}

Json list_of(const Message& message, const FieldDescriptor& field) {
    const Reflection& reflection = *message.GetReflection();
    Json list = Json::array();
    for (int i = 0; i < reflection.FieldSize(message, &field); ++i) {
        list.push_back(field.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE
                           ? to_json(reflection.GetRepeatedMessage(message, &field, i))
                           : value_of(field, [&](auto, auto get) { return (reflection.*get)(message, &field, i); }));
    }
    return list;
}

Json single_of(const Message& message, const FieldDescriptor& field) {
    const Reflection& reflection = *message.GetReflection();
    if (field.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE) {
        return reflection.HasField(message, &field) ? to_json(reflection.GetMessage(message, &field, nullptr)) : Json();
    }
    return value_of(field, [&](auto get, auto) { return (reflection.*get)(message, &field); });
}

template <typename Visit>
void for_each_field(const Descriptor& message, const Visit& visit) {
    for (int i = 0; i < message.field_count(); ++i) {
        const FieldDescriptor& field = *message.field(i);
        if (!field.options().GetExtension(v1::info).only_metrics()) {
            visit(field);
        }
    }
}

Json schema_of_value(const FieldDescriptor& field) {
    switch (field.cpp_type()) {
        case FieldDescriptor::CPPTYPE_MESSAGE: return schema_of(*field.message_type());
        case FieldDescriptor::CPPTYPE_BOOL: return {{"type", "boolean"}};
        case FieldDescriptor::CPPTYPE_ENUM:
        case FieldDescriptor::CPPTYPE_STRING: return {{"type", "string"}};
        default:  // a viewer that plots makes no difference between whole numbers and others
            return {{"type", field.type() == FieldDescriptor::TYPE_FIXED64 ? "string" : "number"}};
    }
}

/// Returns a number for people: lengths in metres, shares in percent.
std::string number_text(double value, const std::string& unit) {
    if (unit == "ratio" && value == 0) {
        return "0 %";
    }
    if (!(value > 0) || !std::isfinite(value)) {
        return "unknown";
    }
    if (unit == "mm") {
        return fmt::format("{:.{}f} m", value / 1000, value < 1000 ? 3 : 2);
    }
    const int decimals = unit == "cores" ? 2 : 1;
    return unit == "ratio" ? fmt::format("{:.1f} %", 100 * value) : fmt::format("{:.{}f} {}", value, decimals, unit);
}

std::string text_of(const Message& message, const FieldDescriptor& field) {
    const Reflection& reflection = *message.GetReflection();
    const std::string& unit = field.options().GetExtension(v1::info).unit();
    switch (field.cpp_type()) {
        case FieldDescriptor::CPPTYPE_STRING: return reflection.GetString(message, &field);
        case FieldDescriptor::CPPTYPE_DOUBLE: return number_text(reflection.GetDouble(message, &field), unit);
        default: break;
    }
    // Of whole numbers, which count something, 0 is known.
    return single_of(message, field).dump() + (unit.empty() ? "" : " ") + unit;
}

}  // namespace

std::vector<Fact> facts_of(const Message& message) {
    std::vector<Fact> facts;
    for_each_field(*message.GetDescriptor(), [&](const FieldDescriptor& field) {
        const v1::FieldInfo& info = field.options().GetExtension(v1::info);
        if (field.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE && !field.is_repeated() &&
            message.GetReflection()->HasField(message, &field)) {
            const std::vector<Fact> inner = facts_of(message.GetReflection()->GetMessage(message, &field, nullptr));
            facts.insert(facts.end(), inner.begin(), inner.end());
        }
        if (const std::string text = info.title().empty() ? "" : text_of(message, field); !text.empty()) {
            facts.push_back({info.title(), text, info.help()});
        }
    });
    return facts;
}

Json to_json(const Message& message) {
    Json json = Json::object();
    for_each_field(*message.GetDescriptor(), [&](const FieldDescriptor& field) {
        json[std::string(field.name())] = field.is_repeated() ? list_of(message, field) : single_of(message, field);
    });
    return json;
}

Json schema_of(const Descriptor& message) {
    Json properties = Json::object();
    for_each_field(message, [&](const FieldDescriptor& field) {
        const Json value = schema_of_value(field);
        properties[std::string(field.name())] = field.is_repeated() ? Json{{"type", "array"}, {"items", value}} : value;
    });
    return {{"type", "object"}, {"properties", properties}};
}

std::string hexadecimal(std::uint64_t id) {
    return fmt::format("{:016x}", id);
}

std::string to_text(const Json& json, int indent) {
    return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace disparityd::json
