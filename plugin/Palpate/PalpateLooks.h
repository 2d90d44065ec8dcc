// SPDX-License-Identifier: BSD-3-Clause
// The first looks of the filters' outputs: defaults of the representations in
// xml/Representations.xml, and colour maps by the name of an array, with names for its values where
// they are kinds and not amounts.
#pragma once

/// Adds the looks to ParaView's settings, below those of the user. Called when the plugin is
/// loaded.
void PalpateAddLooks();
