// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/mcap_reader.h"
#include "formats/ros_bag.h"

namespace disparityd::formats {

/// A bag in an MCAP file. Errors are those of McapReader.
class McapBag final : public RosBag {
public:
    explicit McapBag(const std::string& path);

    const std::map<std::uint32_t, BagConnection>& connections() const override { return connections_; }
    bool lists_all() const override { return reader_.has_summary(); }
    bool next(Message& message) override;
    std::uint64_t position() const override { return reader_.position(); }

private:
    const BagConnection& connection_of(std::uint16_t channel);

    McapReader reader_;
    std::map<std::uint32_t, BagConnection> connections_;
};

}  // namespace disparityd::formats
