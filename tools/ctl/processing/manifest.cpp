// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/processing/manifest.h"

#include <algorithm>
#include <fstream>
#include <set>
#include <stdexcept>

#include "base/version.h"
#include "tools/ctl/processing/digest.h"

namespace disparityd::tools {
namespace {

constexpr int one_line = -1;
constexpr int format = 1;

std::string value_text(const Json& flat, const std::string& key) {
    return flat.contains(key) ? to_text(flat[key], one_line) : "nothing";
}

}  // namespace

ManifestWriter::ManifestWriter(const std::string& folder, const Json& parameters)
    : file_(folder + '/' + manifest_name) {
    file_.write("{\"manifest\": " + std::to_string(format) +
                ",\n\"made_by\": " + to_text(base::version_line("disparityctl"), one_line) +
                ",\n\"parameters\": " + to_text(parameters, one_line) + ",\n\"frames\": [");
    file_.flush();  // after a killed run it says what the folder was begun with
}

void ManifestWriter::add(const Json& frame) {
    file_.write(any_ ? ",\n" : "\n");
    file_.write(to_text(frame, one_line));
    any_ = true;
}

void ManifestWriter::finish(const Json& rest) {
    file_.write("]");
    for (const auto& [key, value] : rest.items()) {
        file_.write(",\n" + to_text(key, one_line) + ": " + to_text(value, one_line));
    }
    file_.write("}\n");
    file_.finish();
}

Json read_manifest(const std::string& folder, const std::function<void(const Json& frame)>& frame) {
    const std::string path = folder + '/' + manifest_name;
    std::ifstream file(path);
    std::string member;
    // A frame is forgotten once it was looked at: there may be millions.
    const auto keep = [&](int depth, Json::parse_event_t event, Json& value) {
        if (depth == 1 && event == Json::parse_event_t::key) {
            member = value.get<std::string>();
        }
        const bool whole_frame = depth == 2 && event == Json::parse_event_t::object_end && member == "frames";
        if (whole_frame) {
            frame(value);
        }
        return !whole_frame;
    };
    try {
        Json manifest = Json::parse(file, keep);
        if (manifest.at("manifest") != format) {
            throw std::invalid_argument(path + ": is of another version: found " +
                                        to_text(manifest["manifest"], one_line) +
                                        ", allowed: " + std::to_string(format));
        }
        for (const char* const member_of_all : {"made_by", "parameters", "frames", "parts", "losses", "files"}) {
            static_cast<void>(manifest.at(member_of_all));
        }
        for (const char* const loss : {"left_out", "damaged", "lost"}) {
            static_cast<void>(manifest["losses"].at(loss));
        }
        return manifest;
    } catch (const Json::exception&) {
        throw DamagedManifest(path + ": is damaged, or no manifest of disparityctl process");
    }
}

std::string sha256_of_geometry(Json geometry) {
    geometry.at("match").erase("backend");
    return sha256(to_text(geometry, one_line));
}

std::string difference(const Json& one, const Json& two, const std::string& other) {
    if (one == two) {
        return {};
    }
    const Json first = one.flatten(), second = two.flatten();
    std::set<std::string> keys;
    for (const Json* const flat : {&first, &second}) {
        for (const auto& [key, value] : flat->items()) {
            keys.insert(key);
        }
    }
    for (const std::string& key : keys) {
        const std::string found = value_text(first, key), wanted = value_text(second, key);
        if (found != wanted) {
            std::string name = key.substr(key.empty() ? 0 : 1);
            std::replace(name.begin(), name.end(), '/', '.');
            return name + " = " + found + ", " + other + ' ' + wanted;
        }
    }
    return {};
}

}  // namespace disparityd::tools
