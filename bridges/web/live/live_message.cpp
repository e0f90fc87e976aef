// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/live/live_message.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <utility>

#include "base/version.h"
#include "bridges/frames/planes.h"
#include "clients/json/message_json.h"
#include "clients/json/scan_json.h"
#include "clients/json/sensor_json.h"
#include "proto/products.h"

namespace disparityd::web {
namespace {

using disparity::PlaneData;
using disparity::Product;
using frames::metres;
using frames::value_at;
using json::Json;
using json::to_text;

constexpr int most_width = 16384;
constexpr double least_rate = 0.01;
constexpr double most_rate = 1000;
constexpr int most_step = 64;

/// Returns the number in an object, within limits. Throws std::invalid_argument with one line.
double number(const Json& object, const char* key, double least, double most, double usual) {
    const auto found = object.find(key);
    if (found == object.end()) {
        return usual;
    }
    const double value = found->is_number() ? found->get<double>() : NAN;
    if (!(value >= least && value <= most)) {
        throw std::invalid_argument(std::string(key) + ": allowed: " + Json(least).dump() + " to " + Json(most).dump());
    }
    return value;
}

bool flag(const Json& object, const char* key) {
    const auto found = object.find(key);
    if (found != object.end() && !found->is_boolean()) {
        throw std::invalid_argument(std::string(key) + ": allowed: true, false");
    }
    return found != object.end() && found->get<bool>();
}

std::vector<Image> images_of(const Json& object) {
    std::vector<Image> images;
    const auto found = object.find("images");
    if (found == object.end()) {
        return images;
    }
    const std::string allowed = "images: allowed: each of " + image_names() + " once";
    if (!found->is_array()) {
        throw std::invalid_argument(allowed);
    }
    for (const Json& name : *found) {
        const std::optional<Image> image =
            name.is_string() ? image_of(name.get_ref<const std::string&>()) : std::nullopt;
        if (!image || std::find(images.begin(), images.end(), *image) != images.end()) {
            throw std::invalid_argument(allowed);
        }
        images.push_back(*image);
    }
    return images;
}

std::optional<RangeM> range_of(const Json& object) {
    const auto found = object.find("range_m");
    if (found == object.end() || found->is_null()) {
        return std::nullopt;
    }
    if (found->is_array() && found->size() == 2 && (*found)[0].is_number() && (*found)[1].is_number()) {
        const RangeM range{(*found)[0].get<double>(), (*found)[1].get<double>()};
        if (range.near > 0 && range.far > range.near && range.far < 1e6) {
            return range;
        }
    }
    throw std::invalid_argument("range_m: allowed: null, or two distances in m, the nearer one first");
}

LiveSubscription subscription_of(const Json& object) {
    LiveSubscription subscription;
    subscription.images = images_of(object);
    const auto encoding = object.find("encoding");
    if (encoding != object.end() && *encoding != "jpeg" && *encoding != "lossless") {
        throw std::invalid_argument("encoding: allowed: \"jpeg\", \"lossless\"");
    }
    subscription.encoding = encoding != object.end() && *encoding == "lossless" ? Encoding::deflate : Encoding::jpeg;
    subscription.max_width = static_cast<int>(number(object, "max_width", 0, most_width, subscription.max_width));
    subscription.max_rate = number(object, "max_rate", 0, most_rate, 0);
    if (subscription.max_rate > 0 && subscription.max_rate < least_rate) {
        throw std::invalid_argument("max_rate: allowed: 0 for all, or 0.01 to 1000");
    }
    subscription.range = range_of(object);
    subscription.cloud_step = static_cast<int>(number(object, "cloud_step", 0, most_step, 0));
    subscription.scan = flag(object, "scan");
    subscription.sensors = flag(object, "sensors");
    return subscription;
}

Point point_of(const Json& object) {
    if (!object.contains("x") && !object.contains("y")) {
        return {};
    }
    const auto coordinate = [&](const char* key) {
        return static_cast<std::uint32_t>(number(object, key, 0, most_width, -1));
    };
    if (!object.contains("x") || !object.contains("y")) {
        throw std::invalid_argument("point: allowed: both of x and y, or none");
    }
    return {{{coordinate("x"), coordinate("y")}}};
}

LiveRequest request_of(const Json& object) {
    const auto type = object.is_object() ? object.find("type") : object.end();
    if (type == object.end() || !type->is_string()) {
        throw std::invalid_argument("allowed: an object with a \"type\"");
    }
    if (*type == "subscribe") {
        return subscription_of(object);
    }
    if (*type == "seen") {
        const auto index = object.find("publish_index");
        if (index == object.end() || !index->is_number_unsigned()) {
            throw std::invalid_argument("publish_index: allowed: a whole number");
        }
        return Seen{index->get<std::uint64_t>()};
    }
    if (*type == "point") {
        return point_of(object);
    }
    throw std::invalid_argument("type: allowed: \"subscribe\", \"seen\", \"point\"");
}

Json flags_of(std::uint32_t flags) {
    constexpr std::array<std::pair<std::uint32_t, const char*>, 6> words{
        {{disparity::unrectified, "unrectified"},
         {disparity::interpolated, "interpolated"},
         {disparity::dropped_before, "dropped_before"},
         {disparity::discontinuity, "discontinuity"},
         {disparity::synthetic, "synthetic"},
         {disparity::exposure_centre, "exposure_centre"}}};
    Json list = Json::array();
    for (const auto& [bit, word] : words) {
        if ((flags & bit) != 0) {
            list.push_back(word);
        }
    }
    const Json doubts = json::doubts_json(flags);
    list.insert(list.end(), doubts.begin(), doubts.end());
    return list;
}

Json or_null(const std::optional<double>& value) {
    return value ? Json(*value) : Json();
}

Json image_json(const EncodedImage& image, std::size_t offset) {
    Json json{{"name", facts_of(image.image).name},
              {"encoding", image.encoding == Encoding::jpeg ? "jpeg" : "deflate"},
              {"type", image.type},
              {"width", image.width},
              {"height", image.height},
              {"offset", offset},
              {"bytes", image.bytes->size()},
              {"range", {image.low, image.high}},
              {"range_m", nullptr}};
    if (image.near_m) {
        json["range_m"] = {*image.near_m, or_null(image.far_m)};
    }
    return json;
}

/// Returns the values of a pixel; null where the frame does not tell.
Json point_json(const disparity::Frame& frame, std::uint32_t x, std::uint32_t y) {
    Json json{{"x", x},
              {"y", y},
              {"disparity_px", nullptr},
              {"depth_m", nullptr},
              {"confidence", nullptr},
              {"depth_error_m", nullptr}};
    const auto inside = [&](const PlaneData* plane) {
        return plane != nullptr && x < plane->width && y < plane->height;
    };
    if (const PlaneData* const plane = frame.plane(Product::disparity); inside(plane)) {
        const auto d16 = value_at<std::int16_t>(*plane, x, y);
        if (d16 != frame.invalid) {
            json["disparity_px"] = d16 / 16.0;
            json["depth_m"] = or_null(metres(frame, d16 / 16.0));
        }
    }
    if (const PlaneData* const plane = frame.plane(Product::confidence); inside(plane)) {
        json["confidence"] = value_at<std::uint8_t>(*plane, x, y);
    }
    if (const PlaneData* const plane = frame.plane(Product::depth_error); inside(plane)) {
        const auto mm = value_at<std::uint16_t>(*plane, x, y);
        json["depth_error_m"] = mm == 0 ? Json() : Json(mm / 1000.0);
    }
    return json;
}

Json frame_json(const LiveFrame& live) {
    const disparity::Frame& frame = live.frame;
    return {{"type", "frame"},
            {"publish_index", frame.publish_index},
            {"sequence", frame.sequence},
            {"captured_ms", static_cast<double>(frame.realtime_ns) / 1e6},
            {"age_ms", age_ms(live)},
            {"width", frame.width},
            {"height", frame.height},
            {"f", frame.f},
            {"cx", frame.cx},
            {"cy", frame.cy},
            {"baseline_mm", frame.baseline_mm},
            {"disparity_offset", frame.disparity_offset},
            {"d_min", frame.d_min},
            {"disparities", frame.disparities},
            {"invalid", frame.invalid},
            {"calibration_id", json::hexadecimal(frame.calibration_id)},
            {"flags", flags_of(frame.flags)},
            {"trust", disparity::trust_of(frame.flags)},
            {"dropped_before", frame.dropped_before}};
}

Bytes head_of(const Json& header) {
    const std::string text = to_text(header, -1);
    const auto size = static_cast<std::uint32_t>(text.size());
    std::string head;
    for (int shift = 0; shift < 32; shift += 8) {
        head += static_cast<char>(size >> shift & 0xFFU);
    }
    return std::make_shared<const std::string>(head + text);
}

Json status_or_null(const DaemonState& state) {
    return state.status ? json::to_json(*state.status) : Json();
}

/// Returns what the page tells of the status without words of its own: [title, text, help] each.
Json facts_of(const DaemonState& state) {
    Json list = Json::array();
    if (state.status) {
        for (const json::Fact& fact : json::facts_of(*state.status)) {
            list.push_back({fact.title, fact.text, fact.help});
        }
    }
    return list;
}

}  // namespace

LiveRequest parse_live_request(std::string_view text) {
    const Json object = Json::parse(text, nullptr, false);
    try {
        return object.is_discarded() ? WrongMessage{"a message is not JSON"} : request_of(object);
    } catch (const std::exception& error) {
        return WrongMessage{error.what()};
    }
}

std::vector<Bytes> frame_message(const LiveFrame& live, const LiveContents& contents) {
    Json header = frame_json(live);
    header["skipped"] = contents.skipped + live.frame.skipped;
    header["scale"] = contents.scale;
    header["images"] = Json::array();
    std::vector<Bytes> parts(1);
    std::size_t offset = 0;
    for (const auto& image : contents.images) {
        header["images"].push_back(image_json(*image, offset));
        offset += image->bytes->size();
        parts.push_back(image->bytes);
    }
    if (contents.cloud) {
        const DepthGrid& cloud = *contents.cloud;
        header["cloud"] = {{"step", cloud.step},
                           {"width", cloud.width},
                           {"height", cloud.height},
                           {"offset", offset},
                           {"bytes", cloud.bytes->size()}};
        parts.push_back(cloud.bytes);
    }
    if (contents.point.pixel) {
        header["point"] = point_json(live.frame, contents.point.pixel->first, contents.point.pixel->second);
    }
    if (const auto scan = contents.scan ? live.frame.scan() : std::nullopt) {
        header["scan"] = json::to_json(*scan);
    }
    parts[0] = head_of(header);
    return parts;
}

std::string hello_message(const DaemonState& state) {
    Json products = Json::array();
    for (const Product product : state.products) {
        products.push_back(proto::product_name(static_cast<std::uint32_t>(product)));
    }
    return to_text({{"type", "hello"}, {"version", base::version_line("disparity-web")}, {"products", products}}, -1);
}

std::string status_message(const DaemonState& state, const LinkFacts& link) {
    return to_text({{"type", "status"},
                    {"daemon", state.there ? "there" : "gone"},
                    {"why", state.why},
                    {"status", status_or_null(state)},
                    {"facts", facts_of(state)},
                    {"link",
                     {{"sent_bytes", link.sent_bytes},
                      {"frames", link.frames},
                      {"skipped", link.skipped},
                      {"scale", link.scale}}}},
                   -1);
}

std::string sensors_message(const disparity::SensorBatch& batch) {
    Json json{{"type", "sensors"}};
    json.update(json::to_json(batch.samples.back(), batch.skipped));
    return to_text(json, -1);
}

std::string error_message(const std::string& text) {
    return to_text({{"type", "error"}, {"error", text}}, -1);
}

}  // namespace disparityd::web
