// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace disparityd::test {

struct Db3Features {
    bool definitions = true;  ///< a table with the definitions of the types, as newer bags have it
    bool packed = false;      ///< each message is packed by zstd
    bool index = true;        ///< of the stamps
};

/// Writes the messages of an MCAP file to a .db3 bag, which must not exist.
void write_db3(const std::string& mcap, const std::string& db3, const Db3Features& features = {});

/// Runs SQL on a database, which is made where there is none.
void run_sql(const std::string& database, const std::string& sql);

}  // namespace disparityd::test
