#include <gtest/gtest.h>
#include <xxhash.h>

#include "datasets/simulator/simulator.hpp"

namespace mosbench {
namespace {

std::uint64_t hash_of(const Simulator& simulator, std::size_t scan_index) {
  const SimulatedScan scan = simulator.scan(scan_index);
  return XXH3_64bits(scan.points.data(), scan.points.size() * sizeof(Point));
}

// A simulated data set is named by scene and seed, and numbers computed from it are compared
// between machines and versions. Whoever changes these hashes changes every such number and says so
// in the change log.
TEST(SimulatedBits, StayTheSameOnEveryMachineAndWithEveryCompiler) {
  EXPECT_EQ(hash_of(built_in_simulator("room", "vlp-16", 1), 3), 11821889868334875057U);
  EXPECT_EQ(hash_of(built_in_simulator("mall", "os1-64", 1), 25), 1260565861572280818U);
  EXPECT_EQ(hash_of(built_in_simulator("campus", "avia", 2), 40), 15697715747684299040U);
  EXPECT_EQ(hash_of(built_in_simulator("street", "os2-128", 3), 31), 11316349133035334405U);
  EXPECT_EQ(hash_of(built_in_simulator("road", "hdl-64e", 6), 20), 6071772777964803080U);
  EXPECT_EQ(hash_of(built_in_simulator("street", "aeva", 5), 100), 10801578845447865568U);
  EXPECT_EQ(hash_of(built_in_simulator("highway", "hdl-64e", 4), 12), 18396837728063777012U);
}

}  // namespace
}  // namespace mosbench
