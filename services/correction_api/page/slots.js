// Places for parts of the page that live in files of their own.

/** Components shown in the panel of the robot in focus, below the buttons; each gets {robot}. */
export const panelParts = [];
