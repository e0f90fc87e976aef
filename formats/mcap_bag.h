// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/mcap_reader.h"
#include "formats/ros_bag.h"

namespace disparityd::formats {

/// A bag in an MCAP file. Errors are those of McapReader.
class McapBag final : public RosBag {
public:
    explicit McapBag(const std::string& path) : reader_(path) {}

    std::map<std::uint32_t, BagConnection> connections() const override;
    bool lists_all() const override { return reader_.has_summary(); }
    bool next(Message& message) override;
    std::uint64_t position() const override { return reader_.position(); }

private:
    McapReader reader_;
};

}  // namespace disparityd::formats
