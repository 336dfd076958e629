// The map shared between threads: many may read at a time, one may change it. Hold a guard briefly,
// and one at a time; solvers copy what they need, solve without a guard, and apply the outcome.
#pragma once

#include <mutex>
#include <shared_mutex>

#include "map/map.h"
#include "util/check.h"
#include "util/fair_shared_mutex.h"

namespace msf {

class SharedMap {
  // That this thread holds a guard: waiting for a second one it would wait for itself.
  class Holding {
   public:
    explicit Holding(const SharedMap& map) : before_(held_) {
      MSF_CHECK(held_ != &map, "a thread holds one guard of a map at a time");
      held_ = &map;
    }
    ~Holding() { held_ = before_; }
    Holding(const Holding&) = delete;
    Holding& operator=(const Holding&) = delete;

   private:
    inline static thread_local const SharedMap* held_ = nullptr;
    const SharedMap* before_;
  };

 public:
  explicit SharedMap(Map map) : map_(std::move(map)) {}

  class Reader {
   public:
    const Map* operator->() const { return map_; }
    const Map& operator*() const { return *map_; }

   private:
    friend class SharedMap;
    explicit Reader(const SharedMap& map) : holding_(map), lock_(map.mutex_), map_(&map.map_) {}
    Holding holding_;
    std::shared_lock<FairSharedMutex> lock_;
    const Map* map_;
  };

  class Writer {
   public:
    Map* operator->() const { return map_; }
    Map& operator*() const { return *map_; }

   private:
    friend class SharedMap;
    explicit Writer(SharedMap& map) : holding_(map), lock_(map.mutex_), map_(&map.map_) {}
    Holding holding_;
    std::unique_lock<FairSharedMutex> lock_;
    Map* map_;
  };

  Reader Read() const { return Reader(*this); }
  Writer Write() { return Writer(*this); }

 private:
  mutable FairSharedMutex mutex_;
  Map map_;
};

}  // namespace msf
