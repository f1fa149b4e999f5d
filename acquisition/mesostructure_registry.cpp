// The table of all types of mesostructures: a new one is a line here.
#include "acquisition/mesostructure.h"
#include "acquisition/mesostructures/types.h"

namespace weft {

std::span<const MesostructureType> mesostructure_types() {
  static const std::vector<MesostructureType> types = {
      checker_type(),      //
      rings_type(),        //
      tissue_type(),       //
      weave_type(),        //
      knit_type(),         //
      corduroy_type(),     //
      leather_type(),      //
      gravel_type(),       //
      brick_type(),        //
      heightfield_type(),  //
      mesh_type(),         //
  };
  return types;
}

}  // namespace weft
