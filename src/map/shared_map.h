// The map shared between threads: many may read at a time, one may change it. Hold a guard briefly;
// solvers copy what they need, solve without a guard, and apply the outcome.
#pragma once

#include <mutex>
#include <shared_mutex>

#include "map/map.h"

namespace msf {

class SharedMap {
 public:
  explicit SharedMap(Map map) : map_(std::move(map)) {}

  class Reader {
   public:
    const Map* operator->() const { return map_; }
    const Map& operator*() const { return *map_; }

   private:
    friend class SharedMap;
    Reader(const Map& map, std::shared_mutex& mutex) : lock_(mutex), map_(&map) {}
    std::shared_lock<std::shared_mutex> lock_;
    const Map* map_;
  };

  class Writer {
   public:
    Map* operator->() const { return map_; }
    Map& operator*() const { return *map_; }

   private:
    friend class SharedMap;
    Writer(Map& map, std::shared_mutex& mutex) : lock_(mutex), map_(&map) {}
    std::unique_lock<std::shared_mutex> lock_;
    Map* map_;
  };

  Reader Read() const { return {map_, mutex_}; }
  Writer Write() { return {map_, mutex_}; }

 private:
  mutable std::shared_mutex mutex_;
  Map map_;
};

}  // namespace msf
