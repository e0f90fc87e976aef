// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <list>
#include <memory>

namespace disparityd::web {

/// A connection that can be ended from outside.
class Connection {
public:
    virtual ~Connection() = default;
    /// Ends the connection now.
    virtual void drop() = 0;
    /// Whether it only holds a place: no request of it is being answered, and it is told no frames.
    virtual bool idle() const = 0;
};

/// Limits the connections of all visitors together. When there is no room, the oldest one that is idle makes
/// place for a new one: who opens many and says nothing keeps nobody out.
class Connections {
public:
    explicit Connections(std::size_t most) : most_(most) {}

    /// Returns whether there is room for this connection. It counts until it ends. `instead_of`: gives it its place.
    bool admit(const std::shared_ptr<Connection>& connection, const Connection* instead_of = nullptr);

    /// Whether the next one has to take the place of another, as far as the last admit() knows.
    bool full() const { return all_.size() >= most_; }

    /// Ends all.
    void drop_all();

private:
    std::size_t most_;
    std::list<std::weak_ptr<Connection>> all_;  ///< the oldest first
};

}  // namespace disparityd::web
