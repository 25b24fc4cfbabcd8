/** Layout of the curves: the fixed scales and directions of the printed report. */
export interface PanelLayout {
  name: string;
  scale: readonly [number, number];
  directions: readonly [string, string];
  unit: string;
}

function panel(name: string, low: number, high: number, down: string, up: string, unit = "deg"): PanelLayout {
  return { name, scale: [low, high], directions: [down, up], unit };
}

/** Rows proximal to distal; columns sagittal, frontal, transverse. null: an empty place. */
export const KINEMATICS: readonly (PanelLayout | null)[] = [
  panel("pelvis_tilt", -20, 40, "Post", "Ant"),
  panel("pelvis_obliquity", -30, 30, "Down", "Up"),
  panel("pelvis_rotation", -40, 40, "Ext", "Int"),
  panel("hip_flexion", -30, 70, "Ext", "Flex"),
  panel("hip_adduction", -30, 30, "Abd", "Add"),
  panel("hip_rotation", -40, 40, "Ext", "Int"),
  panel("knee_flexion", -20, 80, "Ext", "Flex"),
  null,
  null,
  panel("ankle_dorsiflexion", -50, 40, "Plant", "Dorsi"),
  null,
  panel("foot_progression", -50, 40, "Ext", "Int"),
];

/** Columns hip, knee, ankle; rows moments, powers, ground reactions. */
export const KINETICS: readonly PanelLayout[] = [
  panel("hip_extensor_moment", -2, 2, "Flex", "Ext", "N·m/kg"),
  panel("knee_extensor_moment", -1.5, 2, "Flex", "Ext", "N·m/kg"),
  panel("ankle_plantarflexor_moment", -1, 2.5, "Dorsi", "Plant", "N·m/kg"),
  panel("hip_power", -3, 4, "Abs", "Gen", "W/kg"),
  panel("knee_power", -4, 3, "Abs", "Gen", "W/kg"),
  panel("ankle_power", -3, 6, "Abs", "Gen", "W/kg"),
  panel("ground_reaction_vertical", 0, 150, "", "Up", "%BW"),
  panel("ground_reaction_forward", -40, 40, "Back", "Fwd", "%BW"),
  panel("ground_reaction_medial", -20, 20, "Lat", "Med", "%BW"),
];
