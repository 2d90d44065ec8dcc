# SPDX-License-Identifier: BSD-3-Clause
# Read by ctest itself: the environment of every test.

# The ranks are the parallelism.
set(ENV{OMP_NUM_THREADS} 1)
set(ENV{OPENBLAS_NUM_THREADS} 1)
# A program started without mpiexec would look up its host's name, 5 s where there is no DNS.
set(ENV{OMPI_MCA_ess_singleton_isolated} 1)
# All such programs would share one folder, which the first to end removes, also where another is
# just about to use it.
set(ENV{OMPI_MCA_orte_create_session_dirs} 0)
