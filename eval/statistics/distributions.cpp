#include "eval/statistics/distributions.hpp"

// The only file that includes Boost.Math: its headers take a second to compile.
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>

namespace mosbench {

double normal_probability(double z) { return boost::math::cdf(boost::math::normal(), z); }

double normal_quantile(double probability) {
  return boost::math::quantile(boost::math::normal(), probability);
}

double student_probability(double t, double freedom) {
  return boost::math::cdf(boost::math::students_t(freedom), t);
}

double student_quantile(double probability, double freedom) {
  return boost::math::quantile(boost::math::students_t(freedom), probability);
}

}  // namespace mosbench
